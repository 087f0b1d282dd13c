// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "halftone/screens/blue_noise_screen.h"
#include "halftone/screens/built_in_screens.h"
#include "halftone/screens/void_and_cluster.h"
#include "halftone/separation/mixture.h"
#include "screen_analysis.h"

using namespace voxtone;
using namespace voxtone::halftone;
using test::Spectrum;
using test::Tile;

namespace {

constexpr std::array<double, 3> j750 = built_in_screens[0].pitch_mm;

Tile tile_of(const BlueNoiseScreen& screen) {
    Tile tile;
    for (int k = 0; k < 64; ++k)
        for (int j = 0; j < 64; ++j) tile.insert(tile.end(), screen.row(j, k), screen.row(j, k) + 64);
    return tile;
}

double length(const std::array<double, 3>& nu) { return std::hypot(nu[0], nu[1], nu[2]); }

/// Mean distance between the rarer voxels of a share, as a frequency: one over the cube root of the volume per voxel.
double principal_frequency(double share) {
    return std::cbrt(std::min(share, 1 - share) / (j750[0] * j750[1] * j750[2]));
}

double low_frequency_power(const Tile& tile, int first, int last) {
    const double below = 0.4 * principal_frequency((last - first) / 65536.0);
    return Spectrum(tile, j750, first, last).mean([&](const auto& nu) { return length(nu) < below; });
}

/// Largest over smallest of the powers around the x, y and z axis, where the spectrum rises and all three axes reach.
double anisotropy(const Tile& tile, int first, int last) {
    const Spectrum spectrum(tile, j750, first, last);
    const double principal = principal_frequency((last - first) / 65536.0);
    const double highest = std::min(0.6 * principal, 0.5 / j750[1]);
    double least = 1e9, most = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double power = spectrum.mean([&](const auto& nu) {
            return length(nu) >= 0.2 * principal && length(nu) < highest && std::abs(nu[axis]) > 0.85 * length(nu);
        });
        least = std::min(least, power);
        most = std::max(most, power);
    }
    return most / least;
}

/// Intervals of thresholds: single resins from 2 to 50 %, and resins in the midst of a mixture.
constexpr std::array<std::array<int, 2>, 7> intervals{
    {{0, 1311}, {0, 3277}, {0, 6554}, {0, 16384}, {0, 32768}, {20000, 36384}, {60000, 65536}}};

}  // namespace

TEST_CASE("Each threshold occurs four times, so that any cube of 64^3 is right") {
    for (const BuiltInScreen& known : built_in_screens) {
        const BlueNoiseScreen screen(known.pitch_mm);
        REQUIRE(screen.built_in());
        std::vector<int> count(65536, 0);
        for (std::uint16_t t : tile_of(screen)) ++count[t];
        CHECK(std::all_of(count.begin(), count.begin() + 65534, [](int n) { return n == 4; }));
        CHECK(count[65534] == 8);
        CHECK(count[65535] == 0);
    }
}

TEST_CASE("The screen is addressed by position, negative ones too") {
    const BlueNoiseScreen screen(j750);
    for (int n = 0; n < 1000; ++n) {
        RandomStream random(3, static_cast<std::uint64_t>(n));
        const auto draw = [&] { return static_cast<int>(random.bits() % 4001) - 2000; };
        const int i = draw(), j = draw(), k = draw();
        REQUIRE(screen.threshold(i, j, k) == screen.threshold(i + 64, j - 128, k + 640));
        REQUIRE(screen.threshold(i, j, k) == screen.row(j, k)[i & BlueNoiseScreen::mask]);
    }
    // Neighbouring axes are not exchanged.
    CHECK(screen.threshold(1, 2, 3) == screen.row(0, 0)[1 + 64 * (2 + 64 * 3)]);
}

TEST_CASE("A printer whose x and y are exchanged has the same screen, turned") {
    const BlueNoiseScreen screen(j750), across({j750[1], j750[0], j750[2]});
    CHECK_FALSE(across.built_in());
    int unlike = 0, moved = 0;
    for (int z = 0; z < 64; ++z)
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                unlike += across.threshold(x, y, z) != screen.threshold(y, x, z);
                moved += across.threshold(x, y, z) != screen.threshold(x, y, z);
            }
    CHECK(unlike == 0);
    CHECK(moved > 64 * 64 * 62);
}

TEST_CASE("Any resin of any mixture keeps its share within 1 % in every cube of 16^3 voxels", "[slow]") {
    // The worst case over all cubes and all intervals of thresholds, not a sample.
    constexpr double one_percent = 0.01 * 16 * 16 * 16;
    for (const BuiltInScreen& known : built_in_screens) {
        const double worst = test::worst_cube_error(tile_of(BlueNoiseScreen(known.pitch_mm)));
        INFO(known.name << ": worst error " << worst << " of 4096 voxels");
        CHECK(worst <= one_percent);
    }
    CHECK(test::worst_cube_error(test::shuffled(tile_of(BlueNoiseScreen(j750)), 1)) > one_percent);
}

TEST_CASE("Fields of constant colour keep their resins' shares as selected voxel by voxel") {
    const BlueNoiseScreen screen(j750);
    RandomStream random(11, 0);
    for (int field = 0; field < 6; ++field) {
        // Five resins with random shares.
        constexpr int resins = 5;
        CumulativeMixture mixture;
        mixture.bound.fill(65535);
        std::array<double, resins - 1> cut;
        for (double& c : cut) c = random.uniform();
        std::sort(cut.begin(), cut.end());
        for (std::size_t r = 0; r + 1 < resins; ++r) mixture.bound[r] = static_cast<std::uint16_t>(65535 * cut[r]);
        std::array<double, resins> share;
        for (std::size_t r = 0; r < resins; ++r)
            share[r] = ((r + 1 < resins ? mixture.bound[r] : 65536) - (r > 0 ? mixture.bound[r - 1] : 0)) / 65536.0;
        for (int edge : {16, 64}) {
            const double allowed = (edge == 16 ? 0.01 : 0.001) * edge * edge * edge;
            for (int cube = 0; cube < (edge == 16 ? 50 : 2); ++cube) {
                const auto draw = [&] { return static_cast<int>(random.bits() % 1000) - 500; };
                const int i0 = draw(), j0 = draw(), k0 = draw();
                std::array<double, resins> count{};
                for (int k = k0; k < k0 + edge; ++k)
                    for (int j = j0; j < j0 + edge; ++j)
                        for (int i = i0; i < i0 + edge; ++i)
                            ++count[static_cast<std::size_t>(select_resin(mixture, screen.threshold(i, j, k), resins))];
                for (std::size_t r = 0; r < resins; ++r)
                    REQUIRE(std::abs(count[r] - share[r] * edge * edge * edge) <= allowed);
            }
        }
    }
}

TEST_CASE("The spectrum is blue: power is missing at low frequencies") {
    const Tile tile = tile_of(BlueNoiseScreen(j750));
    const Tile white = test::shuffled(tile, 5);
    for (const auto& [first, last] : intervals) {
        INFO("thresholds from " << first << " to " << last);
        CHECK(low_frequency_power(tile, first, last) < 0.1);
        CHECK(low_frequency_power(white, first, last) > 0.8);
    }
}

TEST_CASE("The spectrum is the same along x, y and z in cycles per millimetre", "[slow]") {
    const Tile tile = tile_of(BlueNoiseScreen(j750));
    // A mask that is isotropic in voxels must be told from one that is so in millimetres.
    VoidAndClusterOptions cubic;
    cubic.box_weight = 0;
    const Tile in_voxels = void_and_cluster_thresholds(cubic);
    for (const auto& [first, last] : intervals) {
        INFO("thresholds from " << first << " to " << last);
        CHECK(anisotropy(tile, first, last) < 1.4);
        CHECK(anisotropy(in_voxels, first, last) > 4);
    }
}
