// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <array>

#include "halftone/screens/blue_noise_screen.h"
#include "screen_analysis.h"

using namespace voxtone::halftone;

namespace {

test::Tile tile_of(const BlueNoiseScreen& screen) {
    return test::Tile(screen.row(0, 0), screen.row(0, 0) + 64 * 64 * 64);
}

}  // namespace

TEST_CASE("A pitch that the library does not carry is made at run time, the same each time") {
    const std::array<double, 3> pitch{0.05, 0.05, 0.03};
    REQUIRE_FALSE(has_built_in_screen(pitch));
    const BlueNoiseScreen screen(pitch);
    CHECK_FALSE(screen.built_in());
    const test::Tile tile = tile_of(screen);
    CHECK(tile == tile_of(BlueNoiseScreen({0.5, 0.5, 0.3})));
    CHECK(test::worst_cube_error(tile) <= 0.01 * 4096);
}
