// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optics/monte_carlo/point_spread.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/parallel.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

constexpr int side = 80;

/// White upon grey, in voxels of 0.25 x 0.5 x 0.2 mm: 20 x 40 mm, 1 mm deep.
struct Slab {
    ResinSet set;
    ResinVolume volume;
    explicit Slab(double albedo) {
        set.channels.wavelengths_nm = {550};
        set.eta = 1.5;
        set.resins = {{"white", "W", {5}, {albedo}}, {"grey", "K", {3}, {0.7}}};
        volume = make_resin_volume({side, side, 5}, {0.25, 0.5, 0.2}, [](int, int, int z) { return z >= 2 ? 1 : 2; });
    }
    [[nodiscard]] Scene scene() const { return {&volume, &set, Backing::black, Sides::mirrored}; }
};

constexpr std::uint32_t many = 1 << 18;

RingLight traced(const Slab& slab, const HankelGrid& grid, std::uint32_t paths = many) {
    return trace_point_spread(slab.scene(), {{30, 35}, {50, 45}, ring_edges(grid), paths, 7})[0];
}

/// Largest difference of the light within a ring's edge, in standard errors of a share of so many paths (both are
/// traced).
double largest_deviation(const RingLight& a, const RingLight& b) {
    double sum_a = 0, sum_b = 0, worst = 0;
    for (std::size_t i = 0; i < a.light.size(); ++i) {
        sum_a += a.light[i], sum_b += b.light[i];
        const double error = std::sqrt(2 * std::max(sum_b * (1 - sum_b), 1e-4) / many);
        worst = std::max(worst, std::abs(sum_a - sum_b) / error);
    }
    return worst;
}

}  // namespace

TEST_CASE(
    "Light spreads in voxels of plane layers as it does in the layers, and a resin a little darker is told apart") {
    const HankelGrid grid(8, 32);
    const Slab slab(0.98);
    const LayerScene layers{
        {{slab.set.resins[0].medium(0), 0.6}, {slab.set.resins[1].medium(0), 0.4}}, slab.set.g, 1.5, 1.5};
    const TracedProfile profile = trace_layers(layers, grid, {.paths = many});
    // The largest of some 100 dependent deviations: above 4.5 less than once in a thousand times.
    CHECK(largest_deviation(traced(slab, grid), profile.R) < 4.5);
    CHECK(largest_deviation(traced(Slab(0.97), grid), profile.R) > 4.5);
    CHECK(traced(slab, grid).standard_error == Approx(profile.R.standard_error).epsilon(0.2));
}

TEST_CASE("Point spreads have the same bits for any number of threads, and lose no light") {
    const HankelGrid grid(8, 32);
    const Slab slab(0.98);
    std::vector<RingLight> results;
    for (const std::size_t threads : {1u, 2u, 5u}) {
        const ThreadLimit limit(threads);
        results.push_back(traced(slab, grid, 9000));
    }
    for (const RingLight& other : results) {
        CHECK(other.light == results[0].light);
        CHECK(other.standard_error == results[0].standard_error);
    }
    Slab closed(1);
    closed.set.resins[1].albedo = {1};
    const Scene on_white{&closed.volume, &closed.set, Backing::white, Sides::mirrored};
    const RingLight all = trace_point_spread(on_white, {{0, 0}, {side, side}, {0, 1, 100}, 5000, 1})[0];
    CHECK(all.total == 1.0);
    CHECK(all.light[0] + all.light[1] == 1.0);
}

TEST_CASE("The radius of a share of the light lies between the edges of its ring") {
    const RingLight rings{{0.1, 0.0, 0.3, 0.1}, 0.5, 0};
    const std::vector<double> edges{0, 1, 2, 4, 5};
    CHECK(radius_of_share(rings, edges, 0.1) == Approx(0.5));
    CHECK(radius_of_share(rings, edges, 0.2) == Approx(1));
    CHECK(radius_of_share(rings, edges, 0.5) == Approx(3));
    CHECK(radius_of_share(rings, edges, 0.9) == Approx(4.5));
    CHECK(radius_of_share(rings, edges, 1) == Approx(5));
}
