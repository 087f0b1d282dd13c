// SPDX-License-Identifier: GPL-3.0-or-later
//
// Monte Carlo against the exact solution of plane-parallel layers, as z-tests: (estimate - exact) / standard error is a
// standard normal number where the tracer is right. Every test draws so many paths that a tracer which is 2 % wrong
// would be found out.
#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "slab_scene.h"
#include "voxtone/optics/monte_carlo.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

// A thousandth of all runs of these tests with another seed may fail: 2 (1 - Phi(z)) * 108 tests = 1e-3.
constexpr int tests = 108;
constexpr double largest_z = 4.43;
// So that 2 % lie beyond largest_z by three more standard errors.
constexpr double relative_error = 0.02 / (largest_z + 3);

// Roles C M Y K W of vero_opaque, then mixtures from 6 on.
const ResinSet& resins() {
    static const ResinSet set = with_mixtures(vero_opaque(), {{0.5, 0, 0, 0, 0.5},
                                                              {0, 0.5, 0.5, 0, 0},
                                                              {0.3, 0.3, 0.4, 0, 0},
                                                              {0, 0, 0.1, 0, 0.9},
                                                              {0, 0, 0, 0.05, 0.95},
                                                              {0, 0.02, 0, 0, 0.98},
                                                              {0.2, 0.2, 0.2, 0.2, 0.2}});
    return set;
}

struct Score {
    int done = 0, rejected = 0, blind = 0;
    double sum_of_squares = 0;
    std::string worst;
};

void compare(const std::vector<SlabLayer>& slab, Backing backing, Score& score) {
    // How many paths the wanted error takes is found with paths that are then not used.
    const Appearance pilot = slab_appearance(MonteCarlo({.paths = 20000, .seed = 77}), resins(), slab, backing);
    for (std::size_t c = 0; c < 3; ++c) {
        const double exact = exact_appearance(resins(), slab, backing, c);
        ResinSet channel = resins();  // this channel alone
        channel.channels.wavelengths_nm = {550};
        for (Resin& resin : channel.resins) {
            resin.sigma_t_per_mm = {resin.sigma_t_per_mm[c]};
            resin.albedo = {resin.albedo[c]};
        }
        const double ratio = pilot.standard_error[c] / (relative_error * exact);
        const auto paths = static_cast<std::uint32_t>(std::max(1000.0, 20000 * ratio * ratio * 1.2));
        const Appearance traced =
            slab_appearance(MonteCarlo({.paths = paths, .seed = 5, .first_path = 1000000}), channel, slab, backing);
        const double sigma = std::hypot(traced.standard_error[0], 1e-6);
        const double z = (traced.value[0] - exact) / sigma;
        INFO("top layer " << int(slab[0].material) << " x " << slab[0].voxels << ", " << slab.size()
                          << " layers, backing " << int(backing) << ", channel " << c << ": " << traced.value[0]
                          << " +- " << sigma << ", exact " << exact << ", " << paths << " paths");
        CHECK(std::abs(z) < largest_z);
        // The same test must find out a tracer whose results are 2 % too high or too low.
        CHECK(std::abs(traced.value[0] * 1.02 - exact) / (sigma * 1.02) > largest_z);
        CHECK(std::abs(traced.value[0] * 0.98 - exact) / (sigma * 0.98) > largest_z);
        score.sum_of_squares += z * z;
        ++score.done;
    }
}

}  // namespace

TEST_CASE("Homogeneous and layered slabs agree with the exact solution") {
    Score score;
    const Backing backings[3]{Backing::black, Backing::white, Backing::none};
    for (Material m = 1; m <= 12; ++m) {
        compare({{m, 7}}, backings[m % 3], score);                          // 0.19 mm
        compare({{m, 111}}, backings[(m + 1) % 3], score);  // 3 mm
    }
    const std::vector<std::vector<SlabLayer>> layered{
        {{1, 6}, {5, 60}}, {{3, 3}, {2, 4}, {5, 40}}, {{2, 3}, {3, 4}, {5, 40}},
        {{4, 1}, {5, 30}}, {{5, 5}, {4, 20}},         {{12, 10}, {8, 2}, {1, 1}, {5, 10}, {7, 3}}};
    for (std::size_t i = 0; i < layered.size(); ++i) {
        compare(layered[i], backings[i % 3], score);
        compare(layered[i], backings[(i + 1) % 3], score);
    }
    CHECK(score.done == tests);
    // The z together: chi-squared of 108 degrees of freedom, within four of its standard deviations.
    INFO("sum of z^2 " << score.sum_of_squares);
    CHECK(std::abs(score.sum_of_squares - tests) < 4 * std::sqrt(2.0 * tests));
}
