// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/layer_fields.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::halftone;

namespace {

// Materials 0, 1, 0 with thicknesses (0.2, 0, 0.4), (0.2, 0.3, 0) and nothing.
AlignedLaminates three_laminates() { return {{0, 1, 0}, {0.2, 0, 0.4, 0.2, 0.3, 0, 0, 0, 0}}; }

std::array<float, 3> bottoms(const LayerFields& fields, double x, double y) {
    std::array<float, 3> out{};
    fields.bottoms(x, y, out);
    return out;
}

}  // namespace

TEST_CASE("Height fields have each pixel's laminate at its centre, upright, and layers in order") {
    const std::vector<std::uint16_t> pixels{0, 1, 2, 1, 1, 0};  // two rows of three, 0 at the top left
    const LayerFields fields({3, 2, 6, 4, pixels, MapEdge::extend, 0}, three_laminates());
    CHECK(bottoms(fields, 1, 3) == std::array<float, 3>{0.2f, 0.2f, 0.6f});
    CHECK(bottoms(fields, 3, 3) == std::array<float, 3>{0.2f, 0.5f, 0.5f});
    CHECK(bottoms(fields, 5, 3) == std::array<float, 3>{0, 0, 0});
    CHECK(bottoms(fields, 5, 1) == std::array<float, 3>{0.2f, 0.2f, 0.6f});
    CHECK(fields.most_depth_mm() == 0.6f);
    CHECK(fields.laminate_at(1.9, 2.1) == 0);
    CHECK(fields.laminate_at(4.1, 3.9) == 2);
    CHECK(fields.laminate_at(4.1, 1.9) == 0);
    CHECK(fields.laminate_at(-3, -3) == 1);
    CHECK(fields.layer_at(1, 3, 0) == 0);
    CHECK(fields.layer_at(1, 3, 0.2f) == 2);  // the layer of thickness zero between them holds no depth
    CHECK(fields.layer_at(3, 3, 0.2f) == 1);
    CHECK(fields.layer_at(3, 3, 0.5f) == 3);
    CHECK(fields.layer_at(5, 3, 0) == 3);
}

TEST_CASE("Between two clusters layers run out without a step") {
    const std::vector<std::uint16_t> pixels{0, 1};
    const LayerFields fields({2, 1, 2, 1, pixels, MapEdge::extend, 0}, three_laminates());
    std::array<float, 3> last = bottoms(fields, 0, 0.5);
    const double step = 1e-3;
    for (double x = step; x <= 2; x += step) {
        const std::array<float, 3> now = bottoms(fields, x, 0.5);
        for (std::size_t l = 0; l < 3; ++l)
            CHECK(std::abs(now[l] - last[l]) <= 0.4 * step + 1e-6);  // slopes of 0.3 and 0.1
        last = now;
    }
    CHECK(bottoms(fields, 1, 0.5)[1] == Approx(0.35));
    CHECK(bottoms(fields, 1, 0.5)[2] == Approx(0.55));
}

TEST_CASE("Layers keep their order everywhere, and those of thickness zero stay so to the bit") {
    std::vector<std::uint16_t> pixels;
    RandomStream random(3, 0);
    for (int p = 0; p < 20 * 10; ++p) pixels.push_back(random.uniform() < 0.5 ? 0 : 2);  // none has layer 1
    for (const double smoothing : {0.0, 0.7})
        for (const MapEdge edge : {MapEdge::repeat, MapEdge::mirror, MapEdge::extend}) {
            const LayerFields fields({20, 10, 4, 2, pixels, edge, smoothing}, three_laminates());
            for (int trial = 0; trial < 2000; ++trial) {
                const auto b = bottoms(fields, 30 * random.uniform() - 15, 30 * random.uniform() - 15);
                CHECK(b[0] == b[1]);
                CHECK(b[1] <= b[2]);
                CHECK(b[2] <= fields.most_depth_mm() + 1e-6f);
            }
        }
}

TEST_CASE("Beyond its edges the map is repeated, mirrored or extended") {
    std::vector<std::uint16_t> pixels;
    RandomStream random(5, 0);
    for (int p = 0; p < 7 * 5; ++p) pixels.push_back(std::uint16_t(3 * random.uniform()));
    const auto fields = [&](MapEdge edge) { return LayerFields({7, 5, 7, 5, pixels, edge, 0}, three_laminates()); };
    const LayerFields repeated = fields(MapEdge::repeat), mirrored = fields(MapEdge::mirror),
                      extended = fields(MapEdge::extend);
    for (int trial = 0; trial < 500; ++trial) {
        const double x = 7 * random.uniform(), y = 5 * random.uniform();
        for (std::size_t l = 0; l < 3; ++l) {
            CHECK(bottoms(repeated, x - 14, y + 15)[l] == Approx(bottoms(repeated, x, y)[l]).margin(1e-5));
            CHECK(bottoms(mirrored, -x, y)[l] == Approx(bottoms(mirrored, x, y)[l]).margin(1e-5));
            CHECK(bottoms(mirrored, x, 10 - y)[l] == Approx(bottoms(mirrored, x, y)[l]).margin(1e-5));
            CHECK(bottoms(extended, -x - 1, y)[l] == Approx(bottoms(extended, 0, y)[l]).margin(1e-6));
        }
    }
}

TEST_CASE("Smoothing keeps the mean of a repeated map and takes off its peaks") {
    std::vector<std::uint16_t> pixels(32 * 32, 2);
    pixels[5 * 32 + 30] = 0;
    const LayerFields sharp({32, 32, 3.2, 3.2, pixels, MapEdge::repeat, 0}, three_laminates());
    const LayerFields soft({32, 32, 3.2, 3.2, pixels, MapEdge::repeat, 0.2}, three_laminates());
    double sharp_sum = 0, soft_sum = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            sharp_sum += sharp.depth_mm(0.1 * (x + 0.5), 0.1 * (y + 0.5));
            soft_sum += soft.depth_mm(0.1 * (x + 0.5), 0.1 * (y + 0.5));
        }
    CHECK(soft_sum == Approx(sharp_sum).epsilon(1e-4));
    // 1 / (2 pi sigma^2) of the peak, sigma = 2 px; sampled and cut off at 3 sigma.
    CHECK(soft.most_depth_mm() == Approx(0.6 / (2 * 3.14159265 * 4)).epsilon(0.01));
}
