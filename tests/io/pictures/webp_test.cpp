// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/webp.h"

#include <algorithm>
#include <cstdlib>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "io/layers/rgb.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

constexpr std::uint32_t side_px = 64;
constexpr std::array<Rgb, 6> colours{
    {{0, 150, 200}, {205, 25, 110}, {250, 215, 30}, {30, 30, 30}, {220, 222, 216}, {128, 60, 200}}};

/// Squares of one colour side by side, the last one half covered.
Picture8 squares() {
    Picture8 picture{side_px * std::uint32_t(colours.size()), side_px, 4, {}};
    for (std::uint32_t y = 0; y < side_px; ++y)
        for (std::uint32_t x = 0; x < picture.width_px; ++x) {
            const std::size_t square = x / side_px;
            for (const std::uint8_t code : colours[square]) picture.codes.push_back(code);
            picture.codes.push_back(square + 1 == colours.size() ? 128 : 255);
        }
    return picture;
}

/// A mid-tone halftone: every pixel by chance dark or light.
Picture8 halftone() {
    Picture8 picture{300, 300, 4, {}};
    RandomStream random(3, 1);
    for (std::size_t i = 0; i < std::size_t{300} * 300; ++i) {
        for (int c = 0; c < 3; ++c) picture.codes.push_back(std::uint8_t(110 + 30 * random.uniform()));
        picture.codes.push_back(255);
    }
    return picture;
}

}  // namespace

TEST_CASE("A colour comes back from its WebP within two codes, coverage as it was", "[webp]") {
    const Picture8 picture = squares(), back = read_webp(webp_bytes(picture), "it");
    REQUIRE(back.width_px == picture.width_px);
    REQUIRE(back.height_px == picture.height_px);
    int worst = 0;
    for (std::uint32_t y = 16; y < 48; ++y)
        for (std::uint32_t x = 0; x < picture.width_px; ++x) {
            const std::size_t at = 4 * (std::size_t{y} * picture.width_px + x);
            CHECK(back.codes[at + 3] == picture.codes[at + 3]);
            if (x % side_px < 16 || x % side_px >= 48) continue;  // colours of neighbours ring
            for (std::size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(back.codes[at + c] - picture.codes[at + c]));
        }
    CHECK(worst <= 2);
    CHECK(webp_bytes(picture) == webp_bytes(picture));
}

TEST_CASE("A halftone takes less than a third of its PNG", "[webp]") {
    CHECK(3 * webp_bytes(halftone()).size() < png_bytes(halftone()).size());
}

TEST_CASE("What is no WebP picture, or half of one, is told", "[webp]") {
    const std::vector<std::uint8_t> whole = webp_bytes(squares());
    CHECK(is_webp(whole));
    CHECK_FALSE(is_webp(png_bytes(squares())));
    CHECK_FALSE(is_webp({}));
    CHECK_THROWS_AS(read_webp(png_bytes(squares()), "the picture"), InputError);
    CHECK_THROWS_WITH(read_webp(std::span(whole).first(whole.size() / 2), "the picture"), Contains("the picture is"));
}
