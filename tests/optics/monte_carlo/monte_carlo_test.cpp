// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/monte_carlo.h"

#include <hwy/targets.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

ResinSet one_resin(double sigma_t, double albedo, double g = 0.4, double eta = 1.5) {
    ResinSet set;
    set.name = "test";
    set.channels.wavelengths_nm = {550};
    set.g = g;
    set.eta = eta;
    set.resins = {{"medium", "A", {sigma_t}, {albedo}}};
    return set;
}

}  // namespace

TEST_CASE("White furnace: every path of a body that absorbs nothing counts exactly one") {
    ResinSet set = one_resin(8, 1);
    set.resins.push_back({"thin", "B", {0.5}, {1}});
    set.resins.push_back({"clear", "T", {0}, {1}});
    // A body with steps, holes and a thin wall.
    const ResinVolume volume = make_resin_volume({14, 9, 20}, slab_pitch_mm, [](int x, int y, int z) {
        if (z > 6 && x != 5 && (x + y) % 4 != 0) return 0;
        return 1 + (x * 3 + y * 5 + z * 7) % 3;
    });
    for (const double g : {-0.7, 0.0, 0.4, 0.9})
        for (const double eta : {1.0, 1.5}) {
            set.g = g;
            set.eta = eta;
            for (const Backing backing : {Backing::none, Backing::white}) {
                const Scene scene{&volume, &set, backing, Sides::open};
                const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
                const Appearance seen = MonteCarlo({.paths = 20}).predict(scene, surface);
                REQUIRE(seen.value.size() == surface.cells.size());
                for (std::size_t i = 0; i < seen.value.size(); ++i) {
                    REQUIRE(seen.value[i] == 1.0f);
                    REQUIRE(seen.standard_error[i] == 0.0f);
                }
            }
        }
}

TEST_CASE("Light trapped in clear resin comes out or is ended without bias", "[slow]") {
    // A clear sheet with few specks that scatter: what they send sideways is totally reflected until it meets one
    // again, after some ten thousand reflections, more than a path is let without a throw of the dice.
    ResinSet set = one_resin(0, 1);
    set.resins.push_back({"white", "W", {200}, {1}});
    const ResinVolume volume = make_resin_volume(
        {96, 48, 4}, slab_pitch_mm, [](int x, int y, int z) { return x == 40 && y == 20 && z == 2 ? 2 : 1; });
    for (const PathTracer tracer : {PathTracer::packets, PathTracer::scalar}) {
        const Scene scene{&volume, &set, Backing::none, Sides::mirrored};
        Surface surface = find_surface(scene, {1, 1, 4}, SurfacePart::top);
        surface.cells = {surface.cells[20 * 96 + 40]};  // over the speck
        const Appearance seen = MonteCarlo({.paths = 4000, .tracer = tracer}).predict(scene, surface);
        INFO(seen.value[0] << " +- " << seen.standard_error[0]);
        CHECK(seen.standard_error[0] > 0);
        CHECK(std::abs(seen.value[0] - 1) < 4 * seen.standard_error[0]);
        CHECK(seen.standard_error[0] < 0.05);
    }
}

TEST_CASE("A body and its twin are drawn with random numbers of their own") {
    const ResinSet set = one_resin(8, 0.9);
    const ResinVolume volume = make_resin_volume({8, 4, 12}, slab_pitch_mm, [](int, int, int) { return 1; });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    constexpr std::uint64_t seed = 7;
    const auto [body, twin] =
        MonteCarlo({.paths = 50, .seed = seed}).predict_with_twin(scene, surface, volume);  // the same body
    CHECK(body.value == MonteCarlo({.paths = 50, .seed = seed}).predict(scene, surface).value);
    CHECK(twin.value == MonteCarlo({.paths = 50, .seed = ~seed}).predict(scene, surface).value);
    CHECK(twin.value != body.value);
}

TEST_CASE("Half-spaces look as a prototype and the exact solution say") {
    // physics.md: four digits, 1.6 million paths each.
    const std::vector<std::pair<double, double>> table{{0.35, 0.0124}, {0.7, 0.0553}, {0.95, 0.2648}, {0.99, 0.5194}};
    double chi_squared = 0, chi_squared_if_brighter = 0;
    for (const auto& [albedo, value] : table) {
        // 100 mean free paths thick, over black: what comes back from below is less than a digit.
        const ResinSet set = one_resin(40, albedo);
        const Appearance seen =
            slab_appearance(MonteCarlo({.paths = 200000}), set, std::vector<SlabLayer>{{1, 100}}, Backing::black);
        const double variance = std::pow(seen.standard_error[0], 2) + value * (1 - value) / 1.6e6 + 1e-8 / 12;
        chi_squared += std::pow(seen.value[0] - value, 2) / variance;
        chi_squared_if_brighter += std::pow(1.02 * seen.value[0] - value, 2) / variance;
    }
    // chi-squared of 4 degrees of freedom exceeds 18.5 once in a thousand.
    CHECK(chi_squared < 18.5);
    CHECK(chi_squared_if_brighter > 18.5);
}

TEST_CASE("Paths depend on seed, cell, channel and number alone") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume =
        make_resin_volume({20, 10, 12}, slab_pitch_mm, [](int x, int y, int z) { return 1 + (x / 3 + y / 2 + z) % 5; });
    const Scene scene{&volume, &set, Backing::black, Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    const auto draw = [&](std::size_t threads, const MonteCarloOptions& options) {
        const ThreadLimit limit(threads);
        return MonteCarlo(options).predict(scene, surface);
    };
    const Appearance one = draw(1, {.paths = 300}), many = draw(2, {.paths = 300});
    CHECK(one.value == many.value);
    CHECK(one.standard_error == many.standard_error);
    // Two halves make the whole.
    const Appearance first = draw(2, {.paths = 150}), second = draw(2, {.paths = 150, .first_path = 150});
    CHECK(first.value != second.value);
    for (std::size_t i = 0; i < one.value.size(); ++i)
        REQUIRE(one.value[i] == Approx(0.5 * (first.value[i] + second.value[i])).margin(1e-6));
    CHECK(draw(2, {.paths = 300, .seed = 2}).value != one.value);
    // A piece of the surface has the values that it has within the whole.
    Surface piece = surface;
    piece.cells.assign(surface.cells.begin() + 17, surface.cells.begin() + 29);
    const Appearance part = MonteCarlo({.paths = 300}).predict(scene, piece);
    for (std::size_t i = 0; i < part.value.size(); ++i) REQUIRE(part.value[i] == one.value[17 * 3 + i]);
}

TEST_CASE("The standard error says how far the values are off") {
    const ResinSet set = vero_opaque();
    const std::vector<SlabLayer> slab{{1, 4}, {5, 30}};
    double sum = 0, sum_of_values = 0;
    std::vector<double> values;
    const int runs = 200;
    for (int i = 0; i < runs; ++i) {
        const Appearance seen = slab_appearance(
            MonteCarlo({.paths = 100, .first_path = static_cast<std::uint32_t>(100 * i)}), set, slab, Backing::black);
        sum += std::pow(seen.standard_error[2], 2);
        sum_of_values += seen.value[2];
        values.push_back(seen.value[2]);
    }
    double spread = 0;
    for (const double v : values) spread += std::pow(v - sum_of_values / runs, 2) / (runs - 1);
    // The variance of 200 values is known to 10 %; four times that.
    CHECK(spread / (sum / runs) == Approx(1).margin(0.4));
}

TEST_CASE("Paths are drawn until the wanted standard error is there, or said not to be") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume =
        make_resin_volume({8, 4, 12}, slab_pitch_mm, [](int x, int, int) { return x < 4 ? 4 : 5; });
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    MonteCarloSummary summary;
    const Appearance seen = MonteCarlo({.paths = 32, .error = 0.01}).predict(scene, surface, summary);
    CHECK(summary.error_too_large == 0);
    CHECK(summary.values == seen.value.size());
    CHECK(summary.largest_error <= 0.01);
    CHECK(summary.paths > 32 * seen.value.size());
    (void)MonteCarlo({.paths = 32, .error = 0.01, .max_paths = 64}).predict(scene, surface, summary);
    CHECK(summary.paths <= 64 * seen.value.size());
    CHECK(summary.error_too_large > 0);
    CHECK_THROWS_AS(MonteCarlo({.paths = 1}), InputError);
    CHECK_THROWS_AS(MonteCarlo({.error = -1}), InputError);
}

TEST_CASE("The geometry of calibration is for flat prints") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume =
        make_resin_volume({8, 8, 8}, slab_pitch_mm, [](int x, int, int z) { return z < 7 || x > 2 ? 5 : 0; });
    const Scene scene{&volume, &set, Backing::black, Sides::open};
    MonteCarloSummary summary;
    CHECK_THROWS_AS(MonteCarlo().reflectance_45_0(scene, find_surface(scene, {2, 1, 3}, SurfacePart::top), summary),
                    InputError);
}

TEST_CASE("Every vector unit gives the same bits") {
    ResinSet set = vero_opaque();
    set.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    const ResinVolume volume = make_resin_volume({40, 20, 40}, slab_pitch_mm, [](int x, int y, int z) {
        if ((x - 20) * (x - 20) + 4 * (y - 10) * (y - 10) + (z - 20) * (z - 20) > 380) return 0;
        return x > 20 ? 5 : 1 + (x * 3 + y * 5 + z * 7) % 6;
    });
    const Scene scene{&volume, &set, Backing::white, Sides::open};
    const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::all);
    std::vector<std::vector<float>> values;
    hwy::SetSupportedTargetsForTest(0);
    for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
        hwy::SetSupportedTargetsForTest(targets & -targets);
        values.push_back(MonteCarlo({.paths = 16}).predict(scene, surface).value);
    }
    hwy::SetSupportedTargetsForTest(0);
    REQUIRE(values.size() > 1);
    for (const auto& other : values) CHECK(other == values[0]);
}

TEST_CASE("Droplets that have run together look like the ideal mixture, sharp ones do not", "[slow]") {
    // A halftone of 30 % cyan and 10 % black in white, every voxel drawn by itself.
    const std::vector<double> shares{0.3, 0, 0, 0.1, 0.6};
    ResinSet set = with_mixtures(vero_opaque(), {shares});
    const ResinVolume halftone = make_resin_volume({64, 32, 96}, slab_pitch_mm, [](int x, int y, int z) {
        const double u =
            unit_interval(philox4x32({std::uint32_t(x), std::uint32_t(y), std::uint32_t(z), 0}, {7, 7})[0]);
        return u < 0.3 ? 1 : u < 0.4 ? 4 : 5;
    });
    const auto seen = [&](double spread) {
        set.dot_spread = spread;
        const Scene scene{&halftone, &set, Backing::black, Sides::mirrored};
        const Surface surface = find_surface(scene, {64, 32, 1}, SurfacePart::top);
        return MonteCarlo({.paths = 400'000}).predict(scene, surface);
    };
    const Appearance sharp = seen(0), half = seen(0.5), run = seen(1);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<SlabLayer> ideal{{6, 96}};
        const double exact = exact_appearance(set, ideal, Backing::black, c);
        INFO("channel " << c << ": sharp " << sharp.value[c] << ", half " << half.value[c] << ", run " << run.value[c]
                        << " +- " << run.standard_error[c] << ", ideal " << exact);
        const double noise = 4 * double(run.standard_error[c]);
        CHECK(sharp.value[c] - exact > 1.5 * noise);
        CHECK(std::abs(run.value[c] - exact) < std::min(noise, 0.35 * (sharp.value[c] - exact)));
        CHECK(half.value[c] > run.value[c]);
        CHECK(half.value[c] < sharp.value[c]);
    }
}
