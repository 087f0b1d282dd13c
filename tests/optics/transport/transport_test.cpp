// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/random.h"
#include "optics/grid/transport_directions.h"
#include "optics/layered/layered_appearance.h"
#include "optics/layered/shell_appearance.h"
#include "optics/transport/transport.h"
#include "optics/transport/transport_medium.h"
#include "tests/same_for_threads.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

/// The set with one more resin, a mixture.
ResinSet with_mixture(ResinSet set, const std::vector<double>& fractions) {
    Resin mixture;
    mixture.name = mixture.role = "mixture" + std::to_string(set.resins.size());
    for (std::size_t c = 0; c < 3; ++c) {
        const Medium m = set.mix(fractions, c);
        mixture.sigma_t_per_mm.push_back(m.sigma_t());
        mixture.albedo.push_back(m.albedo());
    }
    set.resins.push_back(mixture);
    return set;
}

/// How far a change of the resins is felt, mm. Predicted, not estimated: on a slab of core resin, 3.2 mm thick over a
/// black sheet, a line of the surface one viewing cell wide and deep is changed from the core's resin to another, all
/// across; the figure is the distance from the line beyond which no channel of the appearance changes by more than the
/// tolerance, 0 where even the line itself changes by less. The slab is 24 mm long: nothing farther is looked for.
double interaction_radius(const ResinSet& resins, const std::array<double, 3>& pitch_mm, std::size_t core,
                          std::size_t changed, double tolerance) {
    constexpr double long_mm = 24, thick_mm = 3.2;
    TransportOptions options;
    options.sweeps = 6;
    options.start_tolerance = 1e-5;
    const std::array<int, 3> view = cell_voxels(pitch_mm, options.cell_mm);
    const std::array<int, 3> size{static_cast<int>(long_mm / (pitch_mm[0] * view[0])) * view[0], 4 * view[1],
                                  static_cast<int>(std::lround(thick_mm / pitch_mm[2]))};
    const auto run = [&](bool line) {
        const ResinVolume volume = make_resin_volume(size, pitch_mm, [&](int x, int, int z) {
            return 1 + (line && x < view[0] && z >= size[2] - view[2] ? changed : core);
        });
        const Scene scene{&volume, &resins, Backing::black, Sides::mirrored};
        return TransportPredictor(options).predict(scene, find_surface(scene, view, SurfacePart::top));
    };
    const Appearance before = run(false), after = run(true);
    const std::size_t columns = static_cast<std::size_t>(size[0] / view[0]), channels = before.channels;
    double radius = 0;
    for (std::size_t x = 0; x < columns; ++x)
        for (std::size_t c = 0; c < channels; ++c)
            if (std::abs(after.value[x * channels + c] - before.value[x * channels + c]) >
                static_cast<float>(tolerance))
                radius = (static_cast<double>(x) + 1) * pitch_mm[0] * view[0];
    return radius;
}

}  // namespace

TEST_CASE("The directions integrate what diffusion needs, and the surface lets diffuse light through exactly") {
    const DirectionSet set = make_directions(0.4, 1.5);
    std::array<double, 3> flux{}, square{};
    double weight = 0;
    for (std::size_t d = 0; d < 8; ++d) {
        weight += set.weight.v[d];
        for (std::size_t a = 0; a < 3; ++a) {
            flux[a] += set.weight.v[d] * set.cosine[a].v[d];
            square[a] += set.weight.v[d] * set.cosine[a].v[d] * set.cosine[a].v[d];
        }
    }
    CHECK(8 * weight == Approx(1).epsilon(1e-6));
    CHECK(4 * flux[2] == Approx(0.25).epsilon(1e-6));
    CHECK(4 * flux[0] == Approx(0.25).epsilon(0.03));  // 2.6 % are what two azimuths per quadrant cost
    for (std::size_t a = 0; a < 3; ++a) CHECK(8 * square[a] == Approx(1.0 / 3).epsilon(1e-5));
    // 1 - R of diffuse light inside, eta = 1.5: Duntley 1942's 0.5963 is R.
    CHECK(set.diffuse_transmittance == Approx(1 - 0.5963).epsilon(1e-3));
    // Through the three kinds of steps of a staircase leaves what leaves through the surface that it stands for.
    for (const std::array<float, 3>& n : {std::array<float, 3>{0.0f, 0.0f, 1.0f},
                                          {0.6f, 0.0f, 0.8f},
                                          {0.5f, 0.5f, 0.7071068f},
                                          {0.1f, -0.2f, 0.9746794f}}) {
        double through = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            if (n[a] == 0) continue;
            const FaceLaw law = face_law(set, axis, n);
            for (std::size_t signs = 0; signs < 4; ++signs)
                for (std::size_t d = 0; d < 8; ++d) {
                    const float t = law.through[signs].v[d];
                    through += std::abs(n[a]) * set.weight.v[d] * set.cosine[a].v[d] * t;
                    CHECK(t >= 0);
                    CHECK(t + law.mirror[signs].v[d] <= 1.000001f);
                }
        }
        INFO(n[0] << ' ' << n[1] << ' ' << n[2]);
        CHECK(through == Approx(0.25 * set.diffuse_transmittance).epsilon(0.02));
    }
}

TEST_CASE("Media carry the albedo that makes a half-space exact") {
    const TransportMedia media(make_directions(0.4, 1.5), {0.0423, 0.0423, 0.027});
    const OrdinatePlan plan = appearance_plan(0.4, 1.5);
    double worst = 0, without = 0;
    for (const double sigma_t : {0.5, 3.0, 8.0, 15.0, 24.0, 40.0})
        for (const double albedo : {0.03, 0.15, 0.35, 0.62, 0.8, 0.93, 0.985, 0.9965, 0.9993, 0.99985}) {
            const double exact = appearance(plan, half_space(plan, {1 - albedo, albedo}));
            worst =
                std::max(worst, std::abs(media.discrete_half_space(1 - media.loss(albedo, sigma_t), sigma_t) - exact));
            without = std::max(without, std::abs(media.discrete_half_space(albedo, sigma_t) - exact));
        }
    CHECK(worst < 3e-4);
    CHECK(without > 1.5e-3);  // it is needed
}

TEST_CASE("A body that absorbs nothing is exactly white, whatever its shape and its clear parts") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo.assign(3, 1.0);
    const ResinVolume volume = make_resin_volume({40, 24, 50}, j750, [](int x, int y, int z) {
        const double r = std::hypot((x - 20) * j750[0], (y - 12) * j750[1], (z - 25) * j750[2]);
        return r < 0.6 ? 1 + (x * 5 + y * 3 + z * 7) % 5 : 0;
    });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    const Appearance seen = TransportPredictor().predict(scene, surface);
    float worst = 0;
    for (const float v : seen.value) {
        REQUIRE(std::isfinite(v));
        worst = std::max(worst, std::abs(v - 1));
    }
    CHECK(worst < 1e-3);
}

TEST_CASE("Homogeneous slabs agree with adding-doubling", "[slow]") {
    const auto backing = GENERATE(Backing::black, Backing::none);
    const auto fractions = GENERATE(std::vector<double>{1, 0, 0, 0, 0}, std::vector<double>{0, 1, 0, 0, 0},
                                    std::vector<double>{0, 0, 1, 0, 0}, std::vector<double>{0, 0, 0, 1, 0},
                                    std::vector<double>{0, 0, 0, 0, 1}, std::vector<double>{0.2, 0.1, 0.3, 0.1, 0.3});
    const ResinSet set = with_mixture(vero_opaque(), fractions);
    const int layers = 60;
    const ResinVolume volume = make_resin_volume({64, 32, layers}, j750, [](int, int, int) { return 6; });
    const Scene scene{&volume, &set, backing, Sides::mirrored};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    TransportOptions options;
    options.sweeps = 6;
    options.refinement = GENERATE(Refinement::none, Refinement::all);
    const Appearance seen = TransportPredictor(options).predict(scene, surface);
    std::vector<double> pure(6, 0.0);
    pure[5] = 1;
    const std::vector<double> exact = ShellAppearance(set, {layers * j750[2] - 0.1, 5, 0.1, backing}).exact(pure);
    for (std::size_t c = 0; c < 3; ++c) {
        double mean = 0;
        for (std::size_t i = 0; i < surface.cells.size(); ++i)
            mean += static_cast<double>(seen.value[3 * i + c]) / static_cast<double>(surface.cells.size());
        INFO("channel " << c << ", refinement " << int(options.refinement));
        CHECK(std::abs(mean - exact[c]) < (options.refinement == Refinement::all ? 0.0025 : 0.006));
    }
}

TEST_CASE("Any number of threads predicts the same bits") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = make_resin_volume({50, 20, 70}, j750, [](int x, int y, int z) {
        return voxtone::RandomStream(1, static_cast<std::uint64_t>((z * 20 + y) * 50 + x)).bits() % 5 + 1;
    });
    const Scene scene{&volume, &set, Backing::black, Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    const auto seen =
        voxtone::test::same_for_threads([&] { return TransportPredictor().predict(scene, surface).value; }, {5});
    CHECK(seen.size() == 3 * surface.cells.size());
}

TEST_CASE("A prediction too large for the memory allowed says what it would need") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = make_resin_volume({100, 60, 60}, j750, [](int, int, int) { return 5; });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    TransportOptions options;
    options.memory_bytes = 1 << 20;
    CHECK_THROWS_WITH(TransportPredictor(options).predict(scene, surface),
                      Catch::Contains("MiB") && Catch::Contains("allow more"));
    options.memory_bytes = std::size_t{400} << 20;
    TransportSummary summary;
    (void)TransportPredictor(options).predict(scene, surface, summary);
    CHECK(summary.pieces == 1);
    CHECK(summary.memory_bytes < options.memory_bytes);
}

TEST_CASE("A change is felt the farther the smaller the tolerance, and farther in white than in black", "[slow]") {
    const ResinSet set = vero_opaque();
    const auto white = static_cast<std::size_t>(set.find("W")), black = static_cast<std::size_t>(set.find("K"));
    const double coarse = interaction_radius(set, j750, white, black, 1e-2),
                 fine = interaction_radius(set, j750, white, black, 1e-4);
    CHECK(coarse > 0.1);
    CHECK(fine > 1.5 * coarse);
    CHECK(fine < 20);
    CHECK(interaction_radius(set, j750, black, white, 1e-2) < coarse);
}
