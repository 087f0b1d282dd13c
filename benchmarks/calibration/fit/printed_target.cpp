// SPDX-License-Identifier: GPL-3.0-or-later
//
// Target B as it is printed: mixtures are random dithers of voxels (J750 High Mix, 42 x 85 x 27 um) on 5 mm of resin,
// with air and a black sheet under it. Monte Carlo of those voxels is the measurement; the fit is made with mixtures
// taken as ideal (Eq. 7), and as halftones (optics/media/effective_medium.h). Pure squares have no voxels to see and
// are exact. With "others": mixtures of 5, 25 and 50 % of other resins, which the dither's constants have not seen; no
// fit. With "equal": the equal mixtures of two to five resins on white, of the chart of edge profiles, and
// what they say of dark channels.
// Run: build/release/benchmarks/printed_target [PATHS per value [others|equal]]
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "calibration/fit/resin_fit.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/target_layout.h"
#include "optics/media/resin_volume.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "tests/calibration/patches/target_samples.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

constexpr std::array<double, 3> pitch_mm{25.4 / 600, 25.4 / 300, 0.027};
constexpr int columns = 128, rows = 64, square_layers = 25, base_layers = 185;

// A square of 5.4 mm with mirrors around it. Returns the shares that the dither came to.
optics::ResinVolume dithered(const Patch& patch, const optics::ResinSet& set, std::uint64_t seed, PatchMixture& made) {
    const auto material = [&](const std::string& role) { return static_cast<optics::Material>(set.find(role) + 1); };
    std::vector<double> count(patch.top.size(), 0);
    auto volume =
        optics::make_resin_volume({columns, rows, base_layers + square_layers}, pitch_mm, [&](int x, int y, int z) {
            if (z < base_layers) return material(patch.backing);
            RandomStream random(seed, static_cast<std::uint64_t>(x + columns * (y + rows * z)));
            double at = random.uniform();
            std::size_t k = 0;
            while (k + 1 < patch.top.size() && at >= patch.top[k].fraction) at -= patch.top[k++].fraction;
            count[k] += 1;
            return material(patch.top[k].role);
        });
    made = patch.top;
    for (std::size_t k = 0; k < made.size(); ++k) made[k].fraction = count[k] / (columns * rows * square_layers);
    return volume;
}

// Resins unlike Vero: dark and opaque, half bright, bright.
optics::ResinSet other_resins() {
    optics::ResinSet set = optics::vero_opaque();
    set.resins[0].sigma_t_per_mm = {15, 25, 6}, set.resins[0].albedo = {0.4, 0.8, 0.02};
    set.resins[1].sigma_t_per_mm = {30, 2, 12}, set.resins[1].albedo = {0.97, 0.5, 0.6};
    set.resins[2].sigma_t_per_mm = {8, 18, 3.5}, set.resins[2].albedo = {0.1, 0.3, 0.9};
    set.resins[4].sigma_t_per_mm = {12, 16, 20}, set.resins[4].albedo = {0.998, 0.9985, 0.9992};
    return set;
}

// Vero as edges tell it, without the extinctions of cyan in red, magenta in green and yellow in blue: what the patches
// say of these.
void print_dark_channels(const char* what, const PatchTable& table, const PatchModelOptions& model) {
    const optics::ResinSet truth = optics::vero_opaque();
    FitOptions options;
    options.model = model;
    options.prior = {"edges", truth.g, truth.eta, {}};
    const Eigen::Matrix2d covariance = Eigen::Vector2d(0.004 * 0.004, 0.03 * 0.03).asDiagonal();
    for (std::size_t r = 0; r < truth.resins.size(); ++r) {
        ResinPrior::Resin& entry = options.prior.resins.emplace_back();
        entry.role = truth.resins[r].role;
        for (std::size_t c = 0; c < 3; ++c)
            entry.channel[c] = {
                {v_of_albedo(truth.resins[r].albedo[c], truth.g), std::log(truth.resins[r].sigma_t_per_mm[c])},
                prior_precision(covariance, true, r != c)};
    }
    const ResinFit fit = fit_resins(table, options);
    fmt::print("Dark channels with {}: extinction / truth, 1 - albedo / truth", what);
    for (std::size_t r = 0; r < 3; ++r) {
        const auto& found = fit.set.resins[static_cast<std::size_t>(fit.set.find(truth.resins[r].role))];
        fmt::print("; {} in {} {:.3f}, {:.3f}", found.role, "RGB"[r],
                   found.sigma_t_per_mm[r] / truth.resins[r].sigma_t_per_mm[r],
                   (1 - found.albedo[r]) / (1 - truth.resins[r].albedo[r]));
    }
    fmt::print("\n");
}

PatchTable equal_mixtures() {
    TargetOptions options;
    options.layout = TargetLayout::e;
    options.roles = {"C", "M", "Y", "K", "W"};
    for (std::size_t k = 0; k < 3; ++k) options.pitch_um[k] = 1000 * pitch_mm[k];
    PatchTable table;
    for (const TargetSquare& square : lay_out_target(options).squares)
        if (square.top.size() == 1 || square.backing == "W")
            table.patches.push_back(
                {square.top, square.backing, square_layers * pitch_mm[2], base_layers * pitch_mm[2], {}, {}, {}});
    return table;
}

void print_errors(const char* what, const ResinFit& fit, const optics::ResinSet& truth) {
    fmt::print("\n{}: chi2 per channel", what);
    for (const double chi2 : fit.chi2) fmt::print(" {:.1f}", chi2);
    fmt::print(
        " of {}, CIEDE2000 of the patches mean {:.2f}\n\n| resin | albedo R G B (truth) | extinction R G B / truth "
        "|\n|---|---|---|\n",
        fit.freedom, fit.patches.differences.mean);
    double sum = 0, count = 0;
    for (const auto& resin : truth.resins) {
        const auto& found = fit.set.resins[static_cast<std::size_t>(fit.set.find(resin.role))];
        fmt::print("| {} |", resin.role);
        for (std::size_t c = 0; c < 3; ++c) fmt::print(" {:.5g} ({:.5g})", found.albedo[c], resin.albedo[c]);
        fmt::print(" |");
        for (std::size_t c = 0; c < 3; ++c) {
            const double ratio = found.sigma_t_per_mm[c] / resin.sigma_t_per_mm[c];
            fmt::print(" {:.3f}", ratio);
            sum += std::log(ratio) * std::log(ratio), ++count;
        }
        fmt::print(" |\n");
    }
    fmt::print("\nrms of ln(extinction / truth): {:.3f}\n", std::sqrt(sum / count));
}

}  // namespace

int main(int count, char** words) {
    const auto paths = static_cast<std::uint32_t>(count > 1 ? std::atoi(words[1]) : 300000);
    const bool others = count > 2 && std::string(words[2]) == "others";
    const optics::ResinSet truth = others ? other_resins() : optics::vero_opaque();
    const std::vector<std::string> colours{"C", "M", "Y"};
    const bool equal = count > 2 && std::string(words[2]) == "equal";
    PatchTable table =
        equal ? equal_mixtures() : testing::target(others ? 'C' : 'B', colours, "W", "K", base_layers * pitch_mm[2]);
    if (others)
        std::erase_if(table.patches, [](const Patch& p) {
            return p.top.size() < 2 || p.top[0].role == "K" || (p.backing == "K" && p.top[0].fraction < 0.2) ||
                   p.top[0].fraction == 0.1;
        });
    PatchModelOptions ideal;
    ideal.under = UnderBase::air;
    PatchModelOptions halftone = ideal;
    halftone.pitch_mm = pitch_mm;
    testing::measure(table, truth, 0, 1, ideal);
    PatchTable as_halftone = table;
    testing::measure(as_halftone, truth, 0, 1, halftone);
    PatchModelOptions screened = halftone;
    screened.dither = {};
    PatchTable as_screened = table;
    testing::measure(as_screened, truth, 0, 1, screened);

    fmt::print(
        "| patch | channel | Monte Carlo | +- | Eq. 7 less | halftone medium less | with the screen's constants "
        "|\n|---|---|---|---|---|---|---|\n");
    const auto began = std::chrono::steady_clock::now();
    double squares_7 = 0, squares_h = 0, squares_s = 0, noise = 0, values = 0;
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        Patch& patch = table.patches[p];
        patch.error.assign(3, 0.0005);
        if (patch.top.size() == 1) continue;
        PatchMixture made;
        const optics::ResinVolume volume = dithered(patch, truth, 11 + p, made);
        const optics::Scene scene{&volume, &truth, optics::Backing::black, optics::Sides::mirrored};
        const optics::Surface surface = find_surface(scene, {columns, rows, 1}, optics::SurfacePart::top);
        optics::MonteCarloSummary summary;
        const optics::Appearance seen =
            optics::MonteCarlo({.paths = paths, .seed = 5 + p}).reflectance_45_0(scene, surface, summary);
        for (std::size_t c = 0; c < 3; ++c) {
            const double rho = seen.value[c], error = seen.standard_error[c];
            const double screen = as_screened.patches[p].rho[c] - rho;
            fmt::print("| {} | {} | {:.4f} | {:.4f} | {:+.4f} | {:+.4f} | {:+.4f} |\n", patch_name(patch), "RGB"[c],
                       rho, error, patch.rho[c] - rho, as_halftone.patches[p].rho[c] - rho, screen);
            squares_s += screen * screen, noise += error * error;
            squares_7 += (patch.rho[c] - rho) * (patch.rho[c] - rho);
            squares_h += (as_halftone.patches[p].rho[c] - rho) * (as_halftone.patches[p].rho[c] - rho);
            ++values;
            patch.rho[c] = rho;
            patch.error[c] = std::max(error, 0.0005);
        }
    }
    fmt::print(
        "\nrms over mixtures: Eq. 7 {:.4f}, halftone medium {:.4f}, with the screen's constants {:.4f}, of which noise "
        "{:.4f}; {} paths a value, {:.0f} s\n",
        std::sqrt(squares_7 / values), std::sqrt(squares_h / values), std::sqrt(squares_s / values),
        std::sqrt(noise / values), paths,
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    if (others) return 0;
    if (equal) {
        print_dark_channels("ideal mixtures", table, ideal);
        print_dark_channels("halftones", table, halftone);
        return 0;
    }
    FitOptions options;
    options.model = ideal;
    print_errors("Fit with ideal mixtures", fit_resins(table, options), truth);
    options.model = halftone;
    print_errors("Fit with halftones", fit_resins(table, options), truth);
    return 0;
}
