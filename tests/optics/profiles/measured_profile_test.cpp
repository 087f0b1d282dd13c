// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/measured_profile.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr double pi = std::numbers::pi;

// total * exp(-r / L) / (2 pi L^2), in samples up to `reach`.
RadialSamples exponential(double total, double L, double spacing, double reach) {
    RadialSamples samples{spacing, {}, {}};
    for (double r = 0; r <= reach; r += spacing) samples.light.push_back(total * std::exp(-r / L) / (2 * pi * L * L));
    return samples;
}

double exponential_hat(double k, double L) { return std::pow(1 + std::pow(2 * pi * k * L, 2), -1.5); }

MeasuredProfile known() { return {0.75, exponential(0.2, 0.8, 0.03, 12), exponential(0.6, 0.3, 0.044, 6)}; }

}  // namespace

TEST_CASE("Measured profiles of different spacing and length become one layer") {
    const HankelGrid grid(10, 64);
    MeasuredSummary summary;
    const LayerProfile layer = measured_layer(known(), grid, summary).of_thickness(0.75);
    for (std::size_t i = 0; i < grid.size(); ++i) {
        // Straight lines between samples: 0.044^2 / (8 * 0.3^2) of the light.
        CHECK(layer.T[i] == Approx(0.2 * exponential_hat(grid.k()[i], 0.8)).margin(0.2 * 2e-4));
        CHECK(layer.R_top[i] == Approx(0.6 * exponential_hat(grid.k()[i], 0.3)).margin(0.6 * 3e-3));
    }
    CHECK(summary.clamped < 1e-12);
    CHECK(summary.negative_R == 0);
    CHECK(summary.beyond_R < 1e-6);
    CHECK(layer.T[3] != Approx(0.2 * exponential_hat(grid.k()[3], 0.9)).margin(0.2 * 2e-4));
}

TEST_CASE("A measured profile is scaled to its albedo") {
    const HankelGrid grid(10, 64);
    MeasuredProfile counts = known();
    for (double& x : counts.R.light) x *= 1234;
    counts.R.total = 0.6;
    MeasuredSummary summary, unscaled;
    const HomogeneousLayer scaled = measured_layer(counts, grid, summary);
    CHECK(summary.R_total == Approx(0.6).epsilon(1e-12));
    CHECK(scaled.of_thickness(0.75).R_top[7] ==
          Approx(measured_layer(known(), grid, unscaled).of_thickness(0.75).R_top[7] * 0.6 / unscaled.R_total)
              .epsilon(1e-9));
    counts.R.total.reset();
    CHECK_THROWS_AS(measured_layer(counts, grid, summary), InputError);  // 740 times the light
}

TEST_CASE("Noisy tails go below zero without making the layer brighter or darker") {
    const HankelGrid grid(10, 64);
    MeasuredProfile noisy = known();
    for (std::size_t i = 0; i < noisy.R.light.size(); ++i)
        noisy.R.light[i] += 2e-3 * (2 * RandomStream(8, i).uniform() - 1);
    MeasuredSummary summary, clean;
    (void)measured_layer(noisy, grid, summary);
    (void)measured_layer(known(), grid, clean);
    CHECK(summary.negative_R > 0.01);
    // Noise of sqrt(1/3) 2e-3 in samples that stand for 2 pi r spacing mm^2 each: 6.4e-3 in all; three of it.
    CHECK(std::abs(summary.R_total - clean.R_total) < 0.02);
    // Cutting what is below zero would have added more.
    double cut = 0;
    for (std::size_t i = 0; i < noisy.R.light.size(); ++i)
        cut += 2 * pi * static_cast<double>(i) * 0.044 * 0.044 * std::max(0.0, noisy.R.light[i]);
    CHECK(cut - clean.R_total > 0.03);
}

TEST_CASE("What lies beyond the last sample is estimated") {
    const HankelGrid grid(10, 64);
    MeasuredProfile cut{0.75, exponential(0.2, 0.8, 0.01, 3), exponential(0.6, 0.3, 0.01, 3)};
    MeasuredSummary summary;
    (void)measured_layer(cut, grid, summary);
    const double x = 3 / 0.8;
    CHECK(summary.beyond_T == Approx((1 + x) * std::exp(-x)).epsilon(0.02));
    CHECK(1 - summary.T_total / 0.2 == Approx(summary.beyond_T).epsilon(0.02));
    cut.R.light.assign(300, 1e-3);  // a background that was not subtracted
    (void)measured_layer(cut, grid, summary);
    CHECK(summary.beyond_R == 1);
}

TEST_CASE("Profiles that cannot be are refused by name") {
    const HankelGrid grid(10, 64);
    MeasuredSummary summary;
    const auto refuses = [&](const MeasuredProfile& profile, const char* word) {
        CHECK_THROWS_WITH(measured_layer(profile, grid, summary), Catch::Contains(word));
        CHECK_THROWS_AS(measured_layer(profile, grid, summary), InputError);
    };
    MeasuredProfile bad = known();
    bad.thickness_mm = 0;
    refuses(bad, "0 mm thick");
    bad = known();
    bad.R.spacing_mm = -0.044;
    refuses(bad, "reflection profile has a spacing of -0.044");
    bad = known();
    bad.T.light.resize(3);
    refuses(bad, "transmission profile has 3 samples");
    bad = known();
    bad.T.light[5] = std::numeric_limits<double>::quiet_NaN();
    refuses(bad, "Sample 5 of the transmission");
    bad = known();
    bad.R.total = 1.2;
    refuses(bad, "total of the reflection profile is 1.2");
    bad = known();
    bad.R.total = 0.9;
    refuses(bad, "more than it got");
    bad = known();
    bad.R.light.assign(100, 0.0);
    bad.R.total = 0.3;
    refuses(bad, "holds no light");
    bad.R.total = 0.0;
    CHECK(measured_layer(bad, grid, summary).of_thickness(0.75).R_top[0] == 0);
}

TEST_CASE(
    "A reflection profile by itself keeps its coefficients as they are, and is refused where it is more than all "
    "light") {
    const HankelGrid grid(10, 32);
    MeasuredSummary summary;
    RadialSamples wanted = exponential(0.6, 0.3, 0.02, 6);
    wanted.light[200] = -0.001;
    const std::vector<double> R = measured_reflection(wanted, grid, summary);
    for (std::size_t i = 0; i < grid.size(); ++i)
        CHECK(R[i] == Approx(0.6 * exponential_hat(grid.k()[i], 0.3)).margin(0.002));
    CHECK(summary.R_total == R[0]);
    CHECK(summary.negative_R > 0);
    CHECK(summary.T_total == 0);

    wanted.total = 0.3;
    CHECK(measured_reflection(wanted, grid, summary)[0] == Approx(0.3).margin(1e-12));
    CHECK_THROWS_AS((void)measured_reflection(exponential(1.1, 0.3, 0.02, 6), grid, summary), InputError);
    CHECK_THROWS_AS((void)measured_reflection({0.02, {1, 2, 3}, {}}, grid, summary), InputError);
}
