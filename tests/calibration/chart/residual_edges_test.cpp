// SPDX-License-Identifier: GPL-3.0-or-later
//
// A residual is fitted to thick, flat mixtures. Beside edges, in stripes and in thin walls it must do no harm: judged
// by Monte Carlo of a printer whose four channels the fitted set of three does not have.
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "calibration/chart/chart_fit.h"
#include "optics/colour/observed_colour.h"
#include "optics/layered/mixture_correction.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/scene/scene.h"
#include "tests/calibration/chart/chart_samples.h"

namespace voxtone::calibration {
namespace {

using optics::Material;

constexpr std::array<double, 3> pitch_mm{0.05, 0.05, 0.03};

constexpr Material white_resin = 5;  // 1 + its index

struct Shares {
    std::array<double, 5> of{};  ///< C, M, Y, K, W
};

// A voxel of the mixture, drawn by its place.
Material drawn(const Shares& shares, int x, int y, int z) {
    double u = RandomStream(17, (static_cast<std::uint64_t>(z) * 64 + static_cast<std::uint64_t>(y)) * 512 +
                                    static_cast<std::uint64_t>(x))
                   .uniform();
    for (std::size_t r = 0; r < 5; ++r) {
        u -= shares.of[r];
        if (u < 0) return static_cast<Material>(r + 1);
    }
    return white_resin;
}

struct Errors {
    double physics = 0, corrected = 0;  ///< mean CIEDE2000 of columns
};

// Columns of the print that lie within `near_mm` of its middle, by the fitted set against the true one; colours
// relative to the white of each, as the loop compares them.
Errors errors_of(const optics::ResinVolume& print, const optics::ResinSet& truth, const optics::ResinSet& fitted,
                 double near_mm) {
    const auto values = [](const optics::ResinVolume& volume, const optics::ResinSet& set, optics::Surface& surface) {
        const optics::Scene scene{&volume, &set, optics::Backing::black, optics::Sides::mirrored};
        surface = find_surface(scene, {1, volume.size()[1], 1}, optics::SurfacePart::top);
        return optics::MonteCarlo({.paths = 2000}).predict(scene, surface);
    };
    const auto seen = [&](const optics::ResinSet& set, optics::Surface& surface) {
        const optics::Appearance white = values(optics::all_of(print, white_resin), set, surface),
                                 appearance = values(print, set, surface);
        // White is the same everywhere: the mean of all its columns.
        std::vector<float> paper(appearance.channels);
        for (std::size_t k = 0; k < white.value.size(); ++k)
            paper[k % paper.size()] += white.value[k] / static_cast<float>(surface.cells.size());
        const optics::ObservedColour<float> observed(set.channels);
        std::vector<Eigen::Vector3f> rgb;
        for (std::size_t i = 0; i < surface.cells.size(); ++i)
            rgb.push_back(observed.relative(appearance.value.data() + i * appearance.channels, paper.data()));
        return rgb;
    };
    optics::Surface surface;
    const std::vector<Eigen::Vector3f> real = seen(truth, surface), physics = seen(fitted, surface);
    std::vector<Eigen::Vector3f> corrected = physics;
    optics::correct_colours(optics::MixtureCorrection(fitted, white_resin - 1).of_surface(print, surface), corrected);
    Errors errors;
    double counted = 0;
    const double middle = 0.5 * print.size()[0] * pitch_mm[0];
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        if (std::abs(static_cast<double>(surface.cells[i].centre_mm[0]) - middle) > near_mm) continue;
        const auto lab = [](const Eigen::Vector3f& rgb) { return optics::lab_from_linear_srgb(rgb.cast<double>()); };
        errors.physics += optics::ciede2000(lab(physics[i]), lab(real[i]));
        errors.corrected += optics::ciede2000(lab(corrected[i]), lab(real[i]));
        ++counted;
    }
    return {errors.physics / counted, errors.corrected / counted};
}

struct Case {
    const char* name;
    Shares left, right;
    double stripe_mm;  ///< 0: an edge; else a stripe of `left` in `right`
    int layers;        ///< over black
};

}  // namespace

TEST_CASE("A residual makes edges, stripes and thin walls no worse, by Monte Carlo") {
    const optics::ResinSet truth = testing::wide_gamut_set();
    ChartFitOptions options;
    options.name = "three channels";
    options.channels = 3;
    options.lengths_from = truth;
    const ChartFit fit = fit_chart(testing::drawn_chart(truth, 240, 1, 0), options);
    REQUIRE(fit.held_out_physics.mean > 1.5 * fit.held_out.mean);

    const std::vector<std::string> loaded{"C", "M", "Y", "K", "W"};
    const optics::ResinSet fitted = fit.set.subset(loaded);
    const Shares cyan{{0.7, 0, 0, 0, 0.3}}, yellow{{0, 0, 0.6, 0, 0.4}}, magenta{{0, 0.5, 0, 0, 0.5}},
        green{{0.3, 0, 0.5, 0, 0.2}}, red{{0, 0.4, 0.4, 0, 0.2}}, dark{{0.2, 0.1, 0, 0.3, 0.4}}, white{{0, 0, 0, 0, 1}};
    const std::vector<Case> cases{{"flat cyan", cyan, cyan, 0, 60},
                                  {"cyan | yellow", cyan, yellow, 0, 40},
                                  {"magenta | white", magenta, white, 0, 40},
                                  {"green | red", green, red, 0, 40},
                                  {"dark | yellow", dark, yellow, 0, 40},
                                  {"0.2 mm of cyan in white", cyan, white, 0.2, 40},
                                  {"0.4 mm of red in green", red, green, 0.4, 40},
                                  {"wall of 0.3 mm, cyan", cyan, cyan, 0, 10},
                                  {"wall of 0.3 mm, magenta | green", magenta, green, 0, 10},
                                  {"wall of 0.15 mm, yellow", yellow, yellow, 0, 5}};
    std::vector<Errors> errors;
    std::string table;
    for (const Case& c : cases) {
        const int width = 48;
        const auto is_left = [&](int x) {
            return c.stripe_mm > 0 ? std::abs((x + 0.5 - width / 2) * pitch_mm[0]) < c.stripe_mm / 2 : 2 * x < width;
        };
        const optics::ResinVolume print = optics::make_resin_volume(
            {width, 8, c.layers}, pitch_mm,
            [&](int x, int y, int z) { return drawn(is_left(x) ? c.left : c.right, x, y, z); });
        errors.push_back(errors_of(print, truth, fitted, 0.3));
        table += fmt::format("{}: physics {:.2f}, corrected {:.2f}\n", c.name, errors.back().physics,
                             errors.back().corrected);
    }
    INFO(table);
    CHECK(errors[0].corrected < 0.5 * errors[0].physics);
    // Beside neighbours a ratio of flat colours can only guess: some places gain, some lose, all in all none is lost.
    double physics = 0, corrected = 0;
    int better = 0;
    for (std::size_t k = 1; k < cases.size(); ++k) {
        physics += errors[k].physics, corrected += errors[k].corrected;
        better += errors[k].corrected < errors[k].physics ? 1 : 0;
    }
    CHECK(corrected < 1.02 * physics);
    CHECK(better >= 5);
}

}  // namespace voxtone::calibration
