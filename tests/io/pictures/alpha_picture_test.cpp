// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/alpha_picture.h"

#include <catch2/catch.hpp>

using namespace voxtone::io;
using Eigen::Vector4f;

namespace {

constexpr std::uint16_t one = 65535;

/// Pixel (x, y) is 1000 x + 10000 y in red, its alpha 1.
AlphaPicture ramp(std::uint32_t width, std::uint32_t height) {
    std::vector<AlphaPicture::Pixel> pixels;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) pixels.push_back({std::uint16_t(1000 * x + 10000 * y), 0, 0, one});
    return {width, height, pixels};
}

float red(const Vector4f& sample) { return sample[0] * float(one); }

}  // namespace

TEST_CASE("A picture with alpha is bilinear between the middles of its pixels, and nothing outside", "[pictures]") {
    const AlphaPicture picture = ramp(4, 3);
    CHECK(picture.width_px() == 4);
    CHECK(picture.height_px() == 3);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x) {
            CHECK(red(picture.sample(float(x) + 0.5f, float(y) + 0.5f)) == Approx(1000 * x + 10000 * y));
            CHECK(picture.sample(float(x) + 0.5f, float(y) + 0.5f)[3] == 1);
        }
    CHECK(red(picture.sample(1.75f, 1.0f)) == Approx(0.75 * 1000 + 0.25 * 2000 + 5000));
    // Half of the border's pixels reach out of the picture, over nothing.
    CHECK(picture.sample(0, 1.5f)[3] == Approx(0.5));
    CHECK(picture.sample(4, 1.5f)[3] == Approx(0.5));
    CHECK(picture.sample(1.5f, 0)[3] == Approx(0.5));
    CHECK(picture.sample(1.5f, 3)[3] == Approx(0.5));
    CHECK(picture.sample(0, 0)[3] == Approx(0.25));
    for (const float out : {-0.5f, 4.5f, 1e8f, -1e8f, 1e9f, std::numeric_limits<float>::quiet_NaN()}) {
        CHECK(picture.sample(out, 1.5f) == Vector4f::Zero());
        CHECK(picture.sample(1.5f, out) == Vector4f::Zero());
    }
    CHECK(red(picture.sample(1.5f, 0.5f, -3)) == Approx(1000));  // no finer than it is
}

TEST_CASE("Smaller copies are means of what they stand for", "[pictures]") {
    const AlphaPicture picture = ramp(4, 4);
    // Level 1: 2 x 2 pixels each.
    CHECK(red(picture.sample(1, 1, 1)) == Approx(500 + 5000));
    CHECK(red(picture.sample(3, 1, 1)) == Approx(2500 + 5000));
    CHECK(red(picture.sample(1, 3, 1)) == Approx(500 + 25000));
    // Between two levels, both.
    const float fine = red(picture.sample(1, 1, 0)), coarse = red(picture.sample(1, 1, 1));
    CHECK(red(picture.sample(1, 1, 0.25f)) == Approx(0.75f * fine + 0.25f * coarse));
    // The last level is the whole picture, and there is none beyond it.
    CHECK(red(picture.sample(2, 2, 2)) == Approx(1500 + 15000));
    CHECK(picture.sample(2, 2, 9) == picture.sample(2, 2, 2));
    // Of an odd size, the last pixel's other half is nothing.
    const AlphaPicture odd = ramp(3, 1);
    CHECK(odd.sample(1, 1, 1)[3] == Approx(0.5).margin(1e-4));
    CHECK(odd.sample(3, 1, 1)[3] == Approx(0.25).margin(1e-4));
    CHECK(red(odd.sample(3, 1, 1)) == Approx(500));
}

TEST_CASE("Texels are kept in linear light times their alpha", "[pictures]") {
    TexelImage image;
    image.width_px = 2, image.height_px = 1;
    image.srgb8 = {255, 188, 0, 255, 255, 255, 255, 51};  // 188: half of the light, to an 8-bit code
    const AlphaPicture picture(image);
    REQUIRE(picture.pixels().size() == 2);
    CHECK(picture.pixels()[0][0] == one);
    CHECK(picture.pixels()[0][1] / double(one) == Approx(0.5).margin(0.003));
    CHECK(picture.pixels()[0][2] == 0);
    CHECK(picture.pixels()[0][3] == one);
    for (std::size_t c = 0; c < 4; ++c) CHECK(picture.pixels()[1][c] == one / 5);
    TexelImage deep;
    deep.width_px = deep.height_px = 1;
    deep.linear16 = {40000, 20000, 10000, 32768};
    const AlphaPicture half(deep);
    CHECK(half.pixels()[0] == AlphaPicture::Pixel{20000, 10000, 5000, 32768});
}
