// SPDX-License-Identifier: GPL-3.0-or-later
//
// The departure of halftones from ideal mixtures: measured by Monte Carlo over random resins, and the constants of
// optics::EffectiveMedium fitted to it.
//
// Each patch has 2 to 5 resins in random shares and 12 channels; in each every resin has a random sigma_t (0.5 to 40
// per mm, even in its logarithm) and albedo (two in five even in [0, 1], else 1 - 10^-4u), so 12 measurements per
// patch. Errors are of 116 cbrt(appearance): L* of the channel as a grey.
//
// Run: build/release/benchmarks/halftone_departure [PATCHES [PATHS [blue-noise|error-diffusion [fit]]]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <Eigen/Dense>

#include "optics/media/effective_medium.h"
#include "tests/halftone/screens/halftone_patch.h"

namespace {

using namespace voxtone;
using Constants = optics::EffectiveMediumConstants;

constexpr std::size_t channels = 12;
constexpr double white_s = 20, white_a = 0.01;

struct Shape {
    const char* name;
    std::array<double, 3> pitch_mm;
    double shell_mm = 1;
    std::size_t up = 2;
    [[nodiscard]] std::array<double, 3> turned() const {
        return {pitch_mm[(up + 1) % 3], pitch_mm[(up + 2) % 3], pitch_mm[up]};
    }
    [[nodiscard]] int layers(double mm) const { return static_cast<int>(std::round(mm / pitch_mm[up])); }
};

constexpr double dpi600 = 25.4 / 600, dpi300 = 25.4 / 300;
std::vector<Shape> shapes{
    {"J750 High Mix, 42 x 85 x 27 um", {dpi600, dpi300, 0.027}},
    {"the same, 0.3 mm deep", {dpi600, dpi300, 0.027}, 0.3},
    {"J750 High Quality, 42 x 85 x 14 um", {dpi600, dpi300, 0.014}},
    {"J55, 85 x 85 x 19 um", {dpi300, dpi300, 0.01875}},
    {"generic, 50 x 50 x 25 um", {0.05, 0.05, 0.025}},
    {"Mimaki, 42 x 42 x 22 um", {dpi600, dpi600, 0.022}},
    {"cubes, 42 um", {dpi600, dpi600, dpi600}},
    {"J750 High Mix seen along x", {dpi600, dpi300, 0.027}, 1, 0},
    {"J750 High Mix seen along y", {dpi600, dpi300, 0.027}, 1, 1},
};

/// One channel of one patch.
struct Sample {
    std::vector<double> fractions;
    optics::ResinSet resins;  ///< one channel
    double seen = 0, error = 0;
};

/// Appearance of a shell of any medium over the white core: a made-up set spans all media.
class AnyShell {
public:
    explicit AnyShell(const Shape& shape) : shell_(set(), geometry(shape)) {}
    [[nodiscard]] double operator()(const optics::Medium& m) const {
        const double a = m.sigma_a / 60, s = m.sigma_s / 60;
        return shell_.appearance(std::array{a, s, 1 - a - s, 0.0})[0];
    }

private:
    static optics::ResinSet set() {
        optics::ResinSet all;
        all.channels.wavelengths_nm = {500};
        all.resins = {{"absorbs", "a", {60}, {0}},
                      {"scatters", "s", {60}, {1}},
                      {"clear", "t", {0}, {1}},
                      {"white", "w", {white_a + white_s}, {white_s / (white_a + white_s)}}};
        return all;
    }
    static optics::ShellGeometry geometry(const Shape& shape) {
        return geometry_of(shape.turned(), 3, shape.layers(shape.shell_mm), shape.layers(1.5), false);
    }
    optics::ShellAppearance shell_;
};

optics::ResinSet random_resins(RandomStream& random, std::size_t count) {
    optics::ResinSet set;
    set.channels.wavelengths_nm.clear();
    for (std::size_t c = 0; c < channels; ++c) set.channels.wavelengths_nm.push_back(400 + 10 * static_cast<double>(c));
    for (std::size_t r = 0; r < count; ++r) {
        optics::Resin resin;
        resin.name = resin.role = std::string(1, static_cast<char>('a' + r));
        for (std::size_t c = 0; c < channels; ++c) {
            resin.sigma_t_per_mm.push_back(0.5 * std::pow(80.0, random.uniform()));
            const double kind = random.uniform(), u = random.uniform();
            resin.albedo.push_back(kind < 0.4 ? u : 1 - std::pow(10.0, -4 * u));
        }
        set.resins.push_back(resin);
    }
    set.resins.push_back({"white", "w", std::vector<double>(channels, white_a + white_s),
                          std::vector<double>(channels, white_s / (white_a + white_s))});
    return set;
}

std::vector<Sample> measure(const Shape& shape, bool blue_noise, int patches, std::uint32_t paths, std::uint64_t seed) {
    const halftone::BlueNoiseScreen screen(shape.pitch_mm);
    std::vector<Sample> samples;
    for (int patch = 0; patch < patches; ++patch) {
        RandomStream random(seed, static_cast<std::uint64_t>(patch));
        const std::size_t n = 2 + random.bits() % 4;
        const optics::ResinSet set = random_resins(random, n);
        std::vector<double> shares(n);
        double sum = 0;
        const double power = 1 + random.uniform();
        for (double& f : shares) sum += f = std::pow(-std::log(1 - random.uniform()), power);
        for (double& f : shares) f /= sum;
        const int resins = static_cast<int>(n), layers = shape.layers(shape.shell_mm), core_layers = shape.layers(1.5);
        const HalftonePatch print =
            blue_noise
                ? make_patch(screen, shape.pitch_mm, cumulative(shares), resins, resins, layers, core_layers, shape.up)
                : make_diffused_patch(shape.pitch_mm, cumulative(shares), resins, resins, layers, core_layers);
        const Seen seen = look(print, set, paths, seed * 1000 + static_cast<std::uint64_t>(patch));
        for (std::size_t c = 0; c < channels; ++c) {
            Sample sample;
            sample.fractions = print.fractions;
            sample.resins.channels.wavelengths_nm = {500};
            for (std::size_t r = 0; r < n; ++r)
                sample.resins.resins.push_back(
                    {"r", "r", {set.resins[r].sigma_t_per_mm[c]}, {set.resins[r].albedo[c]}});
            sample.seen = seen.value[c];
            sample.error = seen.standard_error[c];
            samples.push_back(std::move(sample));
        }
    }
    return samples;
}

double lightness(double appearance) { return 116 * std::cbrt(std::max(appearance, 1e-6)); }

struct Errors {
    double bias = 0, rms = 0, p95 = 0, max = 0, noise = 0;
};

/// Lightness by the model less that seen, of each sample; `pitch_mm` 0: Eq. 7.
std::vector<double> differences(const std::vector<Sample>& samples, const AnyShell& shell,
                                const std::array<double, 3>& pitch_mm, const Constants& constants) {
    std::vector<double> out;
    for (const Sample& s : samples) {
        const optics::EffectiveMedium medium(s.resins, pitch_mm, optics::SeenFrom::above, constants);
        out.push_back(lightness(shell(medium(s.fractions, 0))) - lightness(s.seen));
    }
    return out;
}

double noise_of(const Sample& s) { return 116.0 / 3 * std::pow(std::max(s.seen, 1e-4), -2.0 / 3) * s.error; }

Errors errors_of(const std::vector<Sample>& samples, const std::vector<double>& difference) {
    Errors e;
    std::vector<double> size;
    const double n = static_cast<double>(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        e.bias += difference[i] / n;
        e.rms += difference[i] * difference[i] / n;
        e.noise += noise_of(samples[i]) * noise_of(samples[i]) / n;
        size.push_back(std::abs(difference[i]));
    }
    std::sort(size.begin(), size.end());
    e.p95 = size[static_cast<std::size_t>(0.95 * (n - 1))];
    e.max = size.back();
    e.rms = std::sqrt(std::max(e.rms - e.noise, 0.0));  // the noise of the measurement taken out
    e.noise = std::sqrt(e.noise);
    return e;
}

Constants constants_of(const Eigen::VectorXd& x) { return {x[0], x[1], x[2], x[3], x[4]}; }

/// Least squares by Gauss and Newton with Levenberg's damping; each error counts in units of its noise and 0.3, and
/// large ones as their square root (Huber).
Constants fit(const std::vector<std::vector<Sample>>& samples, const std::vector<AnyShell>& shells) {
    const Constants start;
    Eigen::VectorXd x(5);
    x << start.k_0, start.k_1, start.a, start.b_1, start.h_0;
    const auto residuals = [&](const Eigen::VectorXd& at) {
        std::vector<double> all;
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            const std::vector<double> d = differences(samples[i], shells[i], shapes[i].turned(), constants_of(at));
            for (std::size_t k = 0; k < d.size(); ++k) {
                const double r = d[k] / std::hypot(noise_of(samples[i][k]), 0.3), size = std::abs(r);
                all.push_back(size <= 1 ? r : std::copysign(std::sqrt(2 * size - 1), r));
            }
        }
        return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
    };
    Eigen::VectorXd r = residuals(x);
    double damping = 1e-3;
    for (int step = 0; step < 30 && damping < 1e6; ++step) {
        Eigen::MatrixXd J(r.size(), x.size());
        for (Eigen::Index k = 0; k < x.size(); ++k) {
            Eigen::VectorXd moved = x;
            moved[k] += 1e-4;
            J.col(k) = (residuals(moved) - r) / 1e-4;
        }
        Eigen::MatrixXd H = J.transpose() * J;
        H.diagonal() *= 1 + damping;
        const Eigen::VectorXd next = x - H.ldlt().solve(J.transpose() * r);
        const Eigen::VectorXd there = residuals(next);
        if (there.squaredNorm() < r.squaredNorm()) {
            const bool done = r.squaredNorm() - there.squaredNorm() < 1e-6 * r.squaredNorm();
            x = next, r = there, damping /= 4;
            if (done) break;
        } else {
            damping *= 8;
        }
    }
    return constants_of(x);
}

void print_table(const std::vector<std::vector<Sample>>& samples, const std::vector<AnyShell>& shells,
                 const Constants& constants) {
    std::printf(
        "| voxels | Eq. 7: bias, rms, 95 %%, max | medium of voxels: bias, rms, 95 %%, max | noise "
        "|\n|---|---|---|---|\n");
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Errors e = errors_of(samples[i], differences(samples[i], shells[i], {0, 0, 0}, constants)),
                     m = errors_of(samples[i], differences(samples[i], shells[i], shapes[i].turned(), constants));
        std::printf("| %s | %+.2f, %.2f, %.2f, %.2f | %+.2f, %.2f, %.2f, %.2f | %.2f |\n", shapes[i].name, e.bias,
                    e.rms, e.p95, e.max, m.bias, m.rms, m.p95, m.max, m.noise);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const int patches = argc > 1 ? std::atoi(argv[1]) : 40;
    const auto paths = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 60000);
    const bool blue_noise = argc <= 3 || std::string(argv[3]) != "error-diffusion";
    // Error diffusion is made from below only.
    if (!blue_noise) std::erase_if(shapes, [](const Shape& shape) { return shape.up != 2; });
    std::vector<std::vector<Sample>> samples;
    std::vector<AnyShell> shells;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        samples.push_back(measure(shapes[i], blue_noise, patches, paths, 100 + i));
        shells.emplace_back(shapes[i]);
        std::fprintf(stderr, "measured %s\n", shapes[i].name);
    }
    print_table(samples, shells, {});
    if (argc > 4 && std::string(argv[4]) == "fit") {
        const Constants c = fit(samples, shells);
        std::printf("\nfitted: k_0 %.4f, k_1 %.4f, a %.4f, b_1 %.4f, h_0 %.4f\n\n", c.k_0, c.k_1, c.a, c.b_1, c.h_0);
        print_table(samples, shells, c);
    }
}
