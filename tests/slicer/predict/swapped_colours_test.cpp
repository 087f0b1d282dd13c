// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/swapped_colours.h"

#include <catch2/catch.hpp>

using namespace voxtone::slicer;

TEST_CASE("Resins that were exchanged are doubted, sheets of other programs are not") {
    const ToldColour cyan{{0, 174, 239}, "C", "C"}, magenta{{236, 0, 140}, "VeroMagenta", "M"},
        yellow{{255, 242, 0}, "Y", "Y"}, black{{26, 26, 29}, "K", "K"}, white{{255, 255, 255}, "W", "W"};
    CHECK(swapped_colours(std::vector{cyan, magenta, yellow, black, white}).empty());
    ToldColour wrong = cyan, other = magenta;
    std::swap(wrong.rgb, other.rgb);
    const auto doubts = swapped_colours(std::vector{wrong, other, yellow, black, white});
    REQUIRE(doubts.size() == 2);
    CHECK(doubts[0].find("\"#ec008c=C\"") == 0);
    CHECK(doubts[0].find("'VeroMagenta'") != std::string::npos);
    ToldColour light = white, dark = black;
    std::swap(light.rgb, dark.rgb);
    CHECK(swapped_colours(std::vector{cyan, light, dark}).size() == 2);
    // A role of one's own looks like nothing in particular.
    CHECK(swapped_colours(std::vector{ToldColour{{0, 150, 200}, "Q", "Q"}, magenta}).empty());
    // Alone there is nothing to be swapped with.
    CHECK(swapped_colours(std::vector{ToldColour{{0, 150, 200}, "M", "M"}}).empty());
}
