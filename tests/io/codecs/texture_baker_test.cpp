// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/texture_baker.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "io/pictures/texture.h"

using namespace voxtone;
using namespace voxtone::io;
using Eigen::Vector2f;
using Eigen::Vector3f;
using Eigen::Vector4f;

namespace {

/// 16 bits, so that nothing is coded: rgb and alpha by column and row from the top.
template <class Value>
DecodedImage picture(std::uint32_t width, std::uint32_t height, const Value& value) {
    DecodedImage image;
    image.texels = {width, height, {}, std::vector<std::uint16_t>(4 * std::size_t{width} * height)};
    for (std::uint32_t row = 0; row < height; ++row)
        for (std::uint32_t column = 0; column < width; ++column) {
            const Vector4f rgba = value(column, row);
            for (int c = 0; c < 4; ++c) {
                const auto code = static_cast<std::uint16_t>(std::lround(rgba[c] * 65535));
                image.texels.linear16[4 * (std::size_t{row} * width + column) + std::size_t(c)] = code;
            }
            image.has_alpha = image.has_alpha || rgba.w() < 1;
        }
    return image;
}

BakedLayer of_colour(const std::array<Vector4f, 3>& rgba, bool multiply = false) {
    BakedLayer layer;
    layer.rgba = rgba;
    layer.multiply = multiply;
    return layer;
}

BakedLayer of_picture(std::int32_t image, const std::array<Vector2f, 3>& uv, Wrap wrap = Wrap::repeat) {
    BakedLayer layer;
    layer.image = image;
    layer.uv = uv;
    layer.wrap_u = layer.wrap_v = wrap;
    return layer;
}

/// What is seen at the weights (u, v) of corners 1 and 2.
class Baked {
public:
    Baked(const std::vector<BakedLayer>& layers, const std::vector<DecodedImage>& images) {
        const auto patch = baker_.bake(layers, images);
        REQUIRE(patch);
        uv_ = baker_.uv_of(*patch);
        pages_ = baker_.take_pages();
        REQUIRE(pages_.size() == 1);
        texture_.emplace(pages_[patch->page].texels, Wrap::clamp, Wrap::clamp);
    }
    [[nodiscard]] Vector3f at(float u, float v) const {
        const Vector2f place = (1 - u - v) * uv_[0] + u * uv_[1] + v * uv_[2];
        return texture_->sample(place.x(), place.y());
    }

private:
    TextureBaker baker_;
    std::array<Vector2f, 3> uv_;
    std::vector<DecodedImage> pages_;
    std::optional<Texture> texture_;
};

/// Pages have 8 bits: half a code of sRGB where it is steepest in linear light, 1/255 * 2.4 / 1.055 at white, and what
/// the filter adds between two codes.
constexpr float code = 0.5f / 255 * 2.4f / 1.055f + 1e-4f;

bool near(const Vector3f& a, const Vector3f& b, float margin = code) { return (a - b).cwiseAbs().maxCoeff() < margin; }

}  // namespace

TEST_CASE("A layer lies over others by its alpha, or multiplies them") {
    // A. Porter's and T. Duff's "over" (1984), by hand: red half there over blue a quarter there.
    const Vector4f below(0, 0, 1, 0.25f), above(1, 0, 0, 0.5f);
    const Vector4f over = lay_over(below, above, false);
    const float alpha = 0.5f + 0.25f * 0.5f;
    CHECK(over.w() == Approx(alpha));
    CHECK(over.x() == Approx(0.5 / alpha));
    CHECK(over.z() == Approx(0.125 / alpha));
    CHECK(lay_over(below, {0.3f, 0.4f, 0.5f, 1}, false) == Vector4f(0.3f, 0.4f, 0.5f, 1));
    CHECK(lay_over({0.3f, 0.4f, 0.5f, 1}, {1, 1, 1, 0}, false) == Vector4f(0.3f, 0.4f, 0.5f, 1));
    CHECK(lay_over({0.5f, 0.25f, 1, 0.5f}, {0.5f, 1, 0.5f, 0.5f}, true) == Vector4f(0.25f, 0.25f, 0.5f, 0.25f));
    CHECK(lay_over({0, 0, 0, 0}, {0, 1, 0, 0}, false).w() == 0);
}

TEST_CASE("Colours at corners run over the triangle, whatever its corners") {
    // The two texels around a patch go on beyond the triangle: these colours do so within [0, 1].
    const std::array<Vector4f, 3> corners{Vector4f(0.6f, 0.3f, 0.4f, 1), Vector4f(0.4f, 0.5f, 0.3f, 1),
                                          Vector4f(0.3f, 0.4f, 0.6f, 1)};
    const Baked baked({of_colour(corners)}, {});
    for (float u = 0; u <= 1; u += 0.125f)
        for (float v = 0; u + v <= 1; v += 0.125f)
            CHECK(near(baked.at(u, v), ((1 - u - v) * corners[0] + u * corners[1] + v * corners[2]).head<3>()));
    const Vector4f half(1, 0, 0, 0.5f);
    const Baked over_white({of_colour({half, half, half})}, {});
    CHECK(near(over_white.at(0.3f, 0.3f), {1, 0.5f, 0.5f}));
}

TEST_CASE("Pictures lie at their own coordinates, the lowest below") {
    // A ramp along u and one along v, each with a coordinate system of its own over the triangle.
    constexpr std::uint32_t size = 64;
    const std::vector<DecodedImage> images{
        picture(size, size, [](auto column, auto) { return Vector4f((column + 0.5f) / size, 0, 0, 1); }),
        picture(size, size, [](auto, auto row) { return Vector4f(0, 1 - (row + 0.5f) / size, 0, 0.5f); })};
    const std::array<Vector2f, 3> first{Vector2f(0.1f, 0.2f), Vector2f(0.9f, 0.3f), Vector2f(0.2f, 0.8f)},
        second{Vector2f(0.8f, 0.9f), Vector2f(0.3f, 0.2f), Vector2f(0.1f, 0.6f)};
    const Baked baked({of_picture(0, first), of_picture(1, second)}, images);
    const Baked turned({of_picture(1, second), of_picture(0, first)}, images);
    for (float u = 0.1f; u < 0.9f; u += 0.1f)
        for (float v = 0.1f; u + v < 0.9f; v += 0.1f) {
            const float red = ((1 - u - v) * first[0] + u * first[1] + v * first[2]).x(),
                        green = ((1 - u - v) * second[0] + u * second[1] + v * second[2]).y();
            // Half of the green over all of the red; or the red over all.
            CHECK(near(baked.at(u, v), {0.5f * red, 0.5f * green, 0}, 3 * code));
            CHECK(near(turned.at(u, v), {red, 0, 0}, 3 * code));
        }
}

TEST_CASE("What a picture shows outside of itself is its wrap's") {
    // Four texels of red by the column: 0.1, 0.3, 0.5, 0.7, looked at in their middles.
    const std::vector<DecodedImage> images{
        picture(4, 1, [](auto column, auto) { return Vector4f(0.1f + 0.2f * float(column), 0, 0, 1); })};
    const auto shown = [&](int texel, Wrap wrap) {
        const float u = (float(texel) + 0.5f) / 4;
        const Vector2f place(u, 0.5f);
        return Baked({of_picture(0, {place, place, place}, wrap)}, images).at(0.3f, 0.3f).x();
    };
    const auto texel = [](int n) { return 0.1 + 0.2 * n; };
    for (int n = -9; n < 12; ++n) {
        CAPTURE(n);
        const int repeated = ((n % 4) + 4) % 4, in_two = ((n % 8) + 8) % 8;
        CHECK(shown(n, Wrap::repeat) == Approx(texel(repeated)).margin(code));
        CHECK(shown(n, Wrap::mirror) == Approx(texel(in_two < 4 ? in_two : 7 - in_two)).margin(code));
        CHECK(shown(n, Wrap::clamp) == Approx(texel(std::clamp(n, 0, 3))).margin(code));
        CHECK(shown(n, Wrap::decal) == Approx(n >= 0 && n < 4 ? texel(n) : 1).margin(code));  // white: nothing
    }
}

TEST_CASE("Patches have places of their own, and a page is filled before the next one") {
    TextureBaker baker;
    const std::vector<DecodedImage> images{picture(100, 100, [](auto, auto) { return Vector4f::Ones(); })};
    const auto patch_of = [&](float texels) {
        const float side = texels / 100;
        const auto patch =
            baker.bake(std::vector{of_picture(0, {Vector2f(0, 0), Vector2f(side, 0), Vector2f(0, side)})}, images);
        REQUIRE(patch);
        return *patch;
    };
    struct Square {
        std::size_t page;
        float x, y, size;
    };
    std::vector<Square> squares;
    for (int n = 0; n < 300; ++n) {
        RandomStream random(2, std::uint64_t(n));
        const float texels = 4 + 60 * float(random.uniform());
        const TextureBaker::Patch patch = patch_of(texels);
        const float size = (patch.uv[1] - patch.uv[0]).x();
        const float longest = std::numbers::sqrt2_v<float> * texels;  // of its sides in the picture
        CHECK(size >= longest);                                       // as fine as the picture
        CHECK(size < longest + 9);                                    // in steps of eight texels
        CHECK(patch.uv[2] == patch.uv[0] + Vector2f(0, size));
        squares.push_back({patch.page, patch.uv[0].x(), patch.uv[0].y(), size});
    }
    std::size_t overlaps = 0;
    for (std::size_t a = 0; a < squares.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const Square &p = squares[a], &q = squares[b];
            // Two texels around each are its own.
            overlaps += p.page == q.page && p.x < q.x + q.size + 4 && q.x < p.x + p.size + 4 &&
                        p.y < q.y + q.size + 4 && q.y < p.y + p.size + 4;
        }
    CHECK(overlaps == 0);
}
