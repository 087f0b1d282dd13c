// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/sampled_bssrdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "optics/media/slab_patterns.h"
#include "optics/monte_carlo/layer_paths.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

/// One resin all over.
struct Slab {
    ResinSet set;
    ResinVolume volume;
    [[nodiscard]] Scene scene() const { return {&volume, &set, Backing::black, Sides::mirrored}; }
};

Slab homogeneous(const SampledBssrdfOptions& options, double sigma_t, double albedo, double eta) {
    Slab slab;
    slab.set.channels.wavelengths_nm = {550};
    slab.set.eta = eta;
    slab.set.resins = {{"one", "W", {sigma_t}, {albedo}}};
    const auto columns = [&](std::size_t a, std::uint32_t points) {
        return static_cast<int>(std::ceil(options.first[a] + (points + 2.0 * options.margin) * options.columns[a]));
    };
    slab.volume =
        make_resin_volume({columns(0, options.width), columns(1, options.height), 5},
                          {0.4 / options.columns[0], 0.4 / options.columns[1], 0.2}, [](int, int, int) { return 1; });
    return slab;
}

/// The chance that light that enters somewhere in a cell and leaves r cells away, in any direction, leaves through the
/// cell at an offset.
double landing_chance(double r, PointOffset offset) {
    constexpr int directions = 720;
    const auto overlap = [](double d) { return std::max(0.0, 1 - std::abs(d)); };
    double sum = 0;
    for (int k = 0; k < directions; ++k) {
        const double phi = 2 * std::numbers::pi * (k + 0.5) / directions;
        sum += overlap(offset.x - r * std::cos(phi)) * overlap(offset.y - r * std::sin(phi));
    }
    return sum / directions;
}

}  // namespace

TEST_CASE("A half window holds one of each two opposite offsets") {
    const auto offsets = half_window(2);
    REQUIRE(offsets.size() == 7);  // 13 points within 2 of one
    CHECK(offsets[0] == PointOffset{0, 0});
    CHECK(offsets[1] == PointOffset{1, 0});
    CHECK(offsets[2] == PointOffset{2, 0});
    CHECK(offsets[3] == PointOffset{-1, 1});
    CHECK(offsets[6] == PointOffset{0, 2});
    CHECK(half_window(10).size() == 159);
}

TEST_CASE("Responses of a homogeneous slab are the profile that its layer has") {
    // The same slab twice: voxels with packets of paths, and as a plane layer traced path by path. Cells of a whole
    // grid are pooled by offset; each pooled value is held against its standard error. Cells are columns of voxels, or
    // some columns wide, as in a print.
    for (const auto& [eta, columns] : {std::pair{1.0, std::array{1.0, 1.0}}, {1.5, {1, 1}}, {1.5, {3.3, 1.7}}}) {
        SampledBssrdfOptions options{.width = 24, .height = 20, .margin = 30, .radius = 4, .paths = 800, .seed = 3};
        options.columns = columns;
        if (columns[0] > 1) options.first = {0.4, 0.7};
        const Slab slab = homogeneous(options, 5, 0.98, eta);
        const SampledBssrdf responses = trace_bssrdf(slab.scene(), options);
        const LayerScene scene{{{slab.set.resins[0].medium(0), 1.0}}, slab.set.g, eta, eta};
        const TracedProfile profile = trace_layers(scene, HankelGrid(8, 64), {.paths = 1 << 19});
        const auto offsets = half_window(options.radius);
        const ChannelResponses& data = responses.channels[0];
        double squares = 0, light = 0, expected_light = 0;
        for (std::size_t s = 0; s < offsets.size(); ++s) {
            double expected = 0, spread = 0;
            for (std::size_t ring = 0; ring < profile.R.light.size(); ++ring) {
                const double r = 0.5 * (profile.edges_mm[ring] + profile.edges_mm[ring + 1]) / 0.4,
                             chance = landing_chance(r, offsets[s]);
                expected += chance * profile.R.light[ring];
                spread += chance * chance * profile.R.light[ring];
            }
            const double pairs = (24.0 - std::abs(offsets[s].x)) * (20.0 - offsets[s].y);
            double sum = 0;
            for (std::size_t i = 0; i < responses.points(); ++i) sum += data.pairs[s * responses.points() + i];
            const double found = sum / pairs * responses.cell_mm2();
            const double variance =
                data.noise * (s == 0 ? 2 : 1) * responses.cell_mm2() * expected / pairs + spread / (1 << 19);
            INFO("eta " << eta << ", offset " << offsets[s].x << ", " << offsets[s].y << ": " << found << " for "
                        << expected);
            CHECK(std::abs(found - expected) < 4.5 * std::sqrt(variance));
            squares += (found - expected) * (found - expected) / variance;
            light += found, expected_light += expected;
        }
        // Chi-square of 25 values: above 53 once in a thousand times.
        CHECK(squares < 53);
        CHECK(std::abs(light - expected_light) < 0.01 * light);
    }
}

TEST_CASE("The comparison of responses and layers tells a slab from one that absorbs a little more") {
    const SampledBssrdfOptions options{.width = 24, .height = 20, .margin = 30, .radius = 4, .paths = 800, .seed = 3};
    const auto light_of = [&](double albedo) {
        const SampledBssrdf responses = trace_bssrdf(homogeneous(options, 5, albedo, 1.0).scene(), options);
        double sum = 0;
        for (const float total : responses.channels[0].total) sum += total;
        return sum / static_cast<double>(responses.points());
    };
    const double R =
        trace_layers({{{Medium{0.1, 4.9}, 1.0}}, 0.4, 1, 1}, HankelGrid(8, 64), {.paths = 1 << 19}).R.total;
    CHECK(std::abs(light_of(0.98) - R) < 0.004);
    CHECK(std::abs(light_of(0.975) - R) > 0.004);
}

TEST_CASE("Noise of responses is what the data set says it is") {
    const SampledBssrdfOptions options{.width = 32, .height = 32, .margin = 6, .radius = 2, .paths = 400, .seed = 5};
    const SampledBssrdf responses = trace_bssrdf(homogeneous(options, 6, 0.99, 1.5).scene(), options);
    const ChannelResponses& data = responses.channels[0];
    for (const std::size_t s : {0u, 1u, 5u}) {
        double sum = 0, squares = 0, n = 0;
        for (std::size_t y = 0; y < 30; ++y)
            for (std::size_t x = 2; x < 30; ++x) {
                const double R = data.pairs[s * 1024 + y * 32 + x];
                sum += R, squares += R * R, ++n;
            }
        const double mean = sum / n, variance = squares / n - mean * mean;
        // 840 values know their variance to 5 %; weights differ a little from place to place.
        CHECK(variance / mean == Approx((s == 0 ? 2 : 1) * data.noise).epsilon(0.2));
    }
}

TEST_CASE("No more light leaves a point's window than leaves altogether, and none is lost without absorption") {
    const SampledBssrdfOptions options{.width = 8, .height = 8, .margin = 12, .radius = 6, .paths = 100, .seed = 2};
    const Slab slab = homogeneous(options, 8, 1.0, 1.5);
    const Scene closed{&slab.volume, &slab.set, Backing::white, Sides::mirrored};
    const SampledBssrdf responses = trace_bssrdf(closed, options);
    for (const float total : responses.channels[0].total) CHECK(total == 1.0f);  // a white sheet sends all back up
    const auto within = light_within_window(responses, 0);
    double sum = 0;
    for (const double light : within) sum += light;
    CHECK(sum < 64);
    CHECK(sum > 16);
}

TEST_CASE("Responses have the same bits for any number of threads") {
    const ResinSet set = vero_opaque();
    ResinSet clear = set;
    clear.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    const SampledBssrdfOptions options{.width = 9, .height = 7, .margin = 5, .radius = 3, .paths = 50, .seed = 4};
    SlabOptions slab_options;
    slab_options.width = 9, slab_options.height = 7, slab_options.margin = 5;
    const MixtureSlab slab = make_slab(clear, slab_options);
    const Scene scene{&slab.volume, &slab.mixtures, Backing::black, Sides::mirrored};
    std::vector<SampledBssrdf> results;
    for (const std::size_t threads : {1u, 2u, 5u}) {
        const ThreadLimit limit(threads);
        results.push_back(trace_bssrdf(scene, options));
    }
    REQUIRE(results[0].channels.size() == 3);
    for (const SampledBssrdf& other : results)
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(other.channels[c].pairs == results[0].channels[c].pairs);
            CHECK(other.channels[c].total == results[0].channels[c].total);
            CHECK(other.channels[c].noise == results[0].channels[c].noise);
        }
}

TEST_CASE("Light that a window cannot hold is said") {
    SampledBssrdf responses{5, 5, 1, 0.5, {}};
    ChannelResponses data;
    data.pairs.assign(3 * 25, 0.4f);  // 5 cells of 0.25 mm2: half of the light within the window
    data.total.assign(25, 1.0f);
    responses.channels.push_back(data);
    CHECK(light_within_window(responses, 0)[12] == Approx(0.5));
    CHECK(light_within_window(responses, 0)[0] == Approx(0.3));  // in the corner
    CHECK(share_beyond_window(responses, 0) == Approx(0.5));
}
