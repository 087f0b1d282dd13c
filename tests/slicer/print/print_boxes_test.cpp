// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/print_boxes.h"

#include <cmath>
#include <map>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Eigen::Vector3d;

namespace {

/// Materials of a layer, [j][i], j upwards.
std::vector<std::vector<io::Material>> voxels(const io::LayerRuns& layer) {
    std::vector<std::vector<io::Material>> rows(layer.height_px());
    for (std::uint32_t row = 0; row < layer.height_px(); ++row)
        for (const io::Run& run : layer.row(row))
            rows[layer.height_px() - 1 - row].insert(rows[layer.height_px() - 1 - row].end(), run.length,
                                                     io::Material(run.material));
    return rows;
}

const Vector3d pitch_um(50, 100, 25);

/// Of one dithered box: standardised distance of the share of material 1 from `p`.
double share_distance(double printed, double p, std::uint64_t seed) {
    const BoxLayers layers({{Vector3d::Zero(), {10, 10, 1}, {printed, 1 - printed}}}, {10, 10, 1}, pitch_um, seed);
    double count = 0, all = 0;
    for (std::uint32_t k = 0; k < layers.size()[2]; ++k)
        for (const auto& row : voxels(layers.layer(k)))
            for (const io::Material m : row) {
                count += m == 1;
                ++all;
            }
    return (count - p * all) / std::sqrt(all * p * (1 - p));
}

}  // namespace

TEST_CASE("a voxel belongs to the last box that holds its centre") {
    const BoxLayers layers({{Vector3d::Zero(), {1, 1, 0.1}, {1, 0}}, {{0.5, 0.4, 0.05}, {2, 0.6, 0.2}, {0, 1}}},
                           {1.2, 1, 0.1}, pitch_um, 1);
    CHECK(layers.size() == std::array<std::uint32_t, 3>{24, 10, 4});
    for (std::uint32_t k = 0; k < 4; ++k) {
        const auto rows = voxels(layers.layer(k));
        for (std::size_t j = 0; j < 10; ++j)
            for (std::size_t i = 0; i < 24; ++i) {
                const double x = (double(i) + 0.5) * 0.05, y = (double(j) + 0.5) * 0.1, z = (k + 0.5) * 0.025;
                const bool second = x > 0.5 && y > 0.4 && y < 0.6 && z > 0.05;
                CHECK(int(rows[j][i]) == (second ? 2 : x < 1 ? 1 : 0));
            }
    }
}

TEST_CASE("a checker alternates its two resins in cells from its own corner") {
    const BoxLayers layers(
        {{Vector3d::Zero(), {1, 1, 0.1}, {1, 0, 0}}, {{0.2, 0.3, 0}, {0.9, 0.9, 0.1}, {0, 0.5, 0.5}, {3, 2}}},
        {1, 1, 0.1}, pitch_um, 1);
    const auto rows = voxels(layers.layer(2));
    for (std::size_t j = 0; j < 10; ++j)
        for (std::size_t i = 0; i < 20; ++i) {
            const bool inside = i >= 4 && i < 18 && j >= 3 && j < 9;
            CHECK(int(rows[j][i]) == (!inside ? 1 : ((i - 4) / 3 + (j - 3) / 2) % 2 == 0 ? 2 : 3));
        }
    const BoxLayers finest({{Vector3d::Zero(), {1, 1, 0.1}, {0.5, 0.5}, {1, 1}}}, {1, 1, 0.1}, pitch_um, 1);
    for (std::size_t i = 0; i < 20; ++i) CHECK(int(voxels(finest.layer(0))[3][i]) == (i % 2 == 1 ? 1 : 2));
    const auto refused = [](const PrintBox& box) {
        CHECK_THROWS_WITH(BoxLayers({box}, {1, 1, 0.1}, pitch_um, 1), Contains("two resins"));
    };
    refused({Vector3d::Zero(), {1, 1, 0.1}, {1, 0}, {2, 2}});
    refused({Vector3d::Zero(), {1, 1, 0.1}, {0.5, 0.5}, {2, 0}});
}

TEST_CASE("dithers have the shares of their mixture, and the test sees one percent too much") {
    // z of 160000 voxels: 4 deviations are 0.3 % of a share of 0.1.
    for (const double p : {0.05, 0.1, 0.5, 0.9}) CHECK(std::abs(share_distance(p, p, 3)) < 4);
    CHECK(std::abs(share_distance(0.11, 0.1, 3)) > 4);
}

TEST_CASE("a dither is white: neighbours do not know each other") {
    const BoxLayers layers({{Vector3d::Zero(), {10, 10, 0.05}, {0.3, 0.7}}}, {10, 10, 0.05}, pitch_um, 9);
    const auto below = voxels(layers.layer(0)), above = voxels(layers.layer(1));
    double along_x = 0, along_y = 0, along_z = 0, count = 0;
    for (std::size_t j = 0; j + 1 < below.size(); ++j)
        for (std::size_t i = 0; i + 1 < below[j].size(); ++i) {
            const auto off = [](io::Material m) { return (m == 1) - 0.3; };
            along_x += off(below[j][i]) * off(below[j][i + 1]);
            along_y += off(below[j][i]) * off(below[j + 1][i]);
            along_z += off(below[j][i]) * off(above[j][i]);
            ++count;
        }
    const double deviation = 0.3 * 0.7 * std::sqrt(count);
    CHECK(std::abs(along_x) < 4 * deviation);
    CHECK(std::abs(along_y) < 4 * deviation);
    CHECK(std::abs(along_z) < 4 * deviation);
}

TEST_CASE("a layer does not depend on the others, a seed changes it") {
    const std::vector<PrintBox> boxes{{Vector3d::Zero(), {4, 4, 0.1}, {0.5, 0.5}}};
    const BoxLayers a(boxes, {4, 4, 0.1}, pitch_um, 1), b(boxes, {4, 4, 0.1}, pitch_um, 1),
        c(boxes, {4, 4, 0.1}, pitch_um, 2);
    (void)b.layer(0);
    CHECK(voxels(a.layer(2)) == voxels(b.layer(2)));
    CHECK(voxels(a.layer(2)) != voxels(a.layer(1)));
    CHECK(voxels(a.layer(2)) != voxels(c.layer(2)));
}

TEST_CASE("boxes that cannot be printed are refused") {
    const auto made = [](PrintBox box, Vector3d size) { return BoxLayers({std::move(box)}, size, pitch_um, 1); };
    CHECK_THROWS_WITH(made({{0, 0, 0}, {1, 1, 1}, {0.5, 0.4}}, {1, 1, 1}), Contains("sum to 0.9"));
    CHECK_THROWS_WITH(made({{0, 0, 0}, {1, 1, 1}, {1.5, -0.5}}, {1, 1, 1}), Contains("negative"));
    CHECK_THROWS_WITH(made({{0, 0, 0}, {1, 0, 1}, {1}}, {1, 1, 1}), Contains("no volume"));
    CHECK_THROWS_WITH(made({{0, 0, 0}, {1, 1, 1}, {1}}, {1e6, 1, 1}), Contains("voxels"));
    CHECK_THROWS_WITH(made({{0, 0, 0}, {1, 1, 1}, {1}}, {1, 1, 0}), Contains("along z"));
}
