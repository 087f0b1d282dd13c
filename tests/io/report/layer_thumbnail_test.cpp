// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/layer_thumbnail.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "io/pictures/srgb_code.h"

using namespace voxtone;
using namespace voxtone::io;
using Eigen::Vector4f;

namespace {

const std::vector<Rgb> palette{{9, 9, 9}, {255, 0, 0}, {0, 0, 255}, {128, 128, 128}};
const std::array<double, 2> j750_pitch_mm{25.4 / 600, 25.4 / 300};

LayerRuns random_layer(std::uint32_t width, std::uint32_t height, std::uint64_t seed) {
    LayerRuns layer(width, height);
    RandomStream random(seed, 0);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width;) {
            const std::uint32_t length = std::min(width - x, 1 + random.bits() % 9);
            layer.push(length, Material(random.bits() % 4));
            x += length;
        }
        layer.end_row();
    }
    return layer;
}

}  // namespace

TEST_CASE("An inch is square although it has 600 x 300 pixels") {
    LayerRuns layer(600, 300);
    for (int y = 0; y < 300; ++y) {
        layer.push(600, 1);
        layer.end_row();
    }
    for (const std::uint32_t longest_px : {1u, 7u, 100u, 299u, 600u, 1000u}) {
        const LinearPicture picture = layer_thumbnail(layer, palette, j750_pitch_mm, longest_px);
        CHECK(picture.width_px == longest_px);
        CHECK(picture.height_px == longest_px);
        CHECK(std::all_of(picture.pixels.begin(), picture.pixels.end(),
                          [](const Vector4f& pixel) { return (pixel - Vector4f(1, 0, 0, 1)).norm() < 1e-4f; }));
    }
}

TEST_CASE("A thumbnail has the light of the layer and lies as the bitmap does") {
    // The top left quarter red, the bottom right pixel blue, the rest empty.
    LayerRuns layer(4, 4);
    for (int y = 0; y < 4; ++y) {
        layer.push(2, y < 2 ? 1 : 0);
        layer.push(1, 0);
        layer.push(1, y == 3 ? 2 : 0);
        layer.end_row();
    }
    const LinearPicture picture = layer_thumbnail(layer, palette, {1, 1}, 2);
    REQUIRE(picture.pixels.size() == 4);
    CHECK(picture.pixels[0] == Vector4f(1, 0, 0, 1));
    CHECK(picture.pixels[1] == Vector4f(0, 0, 0, 0));
    CHECK(picture.pixels[2] == Vector4f(0, 0, 0, 0));
    CHECK(picture.pixels[3] == Vector4f(0, 0, 1, 0.25f));
}

TEST_CASE("Area averaging loses nothing, for sizes that do not divide") {
    const LayerRuns layer = random_layer(97, 53, 3);
    Vector4f expected = Vector4f::Zero();  // in square mm
    const auto& linear = srgb8_to_linear();
    for (std::uint32_t y = 0; y < 53; ++y)
        for (const Run& run : layer.row(y))
            if (run.material) {
                const Rgb& rgb = palette[run.material];
                expected += float(run.length) * Vector4f(linear[rgb[0]], linear[rgb[1]], linear[rgb[2]], 1);
            }
    expected *= float(j750_pitch_mm[0] * j750_pitch_mm[1]);
    for (const std::uint32_t longest_px : {1u, 3u, 17u, 96u, 97u, 250u}) {
        const LinearPicture picture = layer_thumbnail(layer, palette, j750_pitch_mm, longest_px);
        const double side_mm = 53 * j750_pitch_mm[1] / longest_px;
        Vector4f sum = Vector4f::Zero();
        for (const Vector4f& p : picture.pixels) sum += p[3] * Vector4f(p[0], p[1], p[2], 1);
        INFO(longest_px);
        CHECK((sum * float(side_mm * side_mm) - expected).norm() < 1e-4f * expected.norm());
        CHECK(picture.width_px == std::uint32_t(std::ceil(97 * j750_pitch_mm[0] / side_mm)));
    }
}
