// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/shard_cut.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("Shards tile the layers at borders of slabs, and share the work", "[shards]") {
    std::vector<double> work(100);
    for (std::size_t s = 0; s < work.size(); ++s) work[s] = 1 + std::sin(0.1 * double(s)) * std::sin(0.1 * double(s));
    const double total = std::accumulate(work.begin(), work.end(), 0.0);
    constexpr int slab = 8;
    for (const LayerRange all : {LayerRange{0, 795}, LayerRange{5, 301}, LayerRange{17, 18}})
        for (const std::uint32_t n : {1u, 2u, 5u, 16u, 200u}) {
            int next = all.first;
            for (std::uint32_t i = 1; i <= n; ++i) {
                const LayerRange mine = shard_layers(work, slab, all, {i, n});
                CHECK(mine.first == next);
                REQUIRE(mine.layers() >= 0);
                next = mine.last + 1;
                if (next != all.last + 1) CHECK((next % slab == 0 || next == all.first));
                if (all.layers() < 700 || n > 16) continue;
                double sum = 0;
                for (int k = mine.first; k <= mine.last; ++k) sum += work[std::size_t(k / slab)] / slab;
                CHECK(std::abs(sum - total / n) <= 2);  // a slab at most, of 2
            }
            CHECK(next == all.last + 1);
        }
}

TEST_CASE("A border stands where the work below it is nearest to its share", "[shards]") {
    // Of 24 in two: 10 below is nearer to 12 than 16, and 14 than 8.
    CHECK(shard_layers({10, 6, 4, 4}, 8, {0, 31}, {1, 2}).last == 7);
    CHECK(shard_layers({4, 4, 6, 10}, 8, {0, 31}, {1, 2}).last == 23);
    CHECK(shard_layers({4, 4, 6, 10}, 8, {0, 31}, {2, 2}).first == 24);
}

TEST_CASE("A box has its work where its surface is", "[shards]") {
    JobBody body;
    body.grid.pitch_mm = {0.05, 0.05, 0.05};
    body.grid.size = {200, 200, 200};
    SolidMesh solid;
    for (int corner = 0; corner < 8; ++corner)
        solid.positions_mm.emplace_back(corner & 1 ? 10 : 0, corner & 2 ? 10 : 0, corner & 4 ? 10 : 0);
    solid.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    VisibleSurface surface;
    surface.positions_mm = solid.positions_mm;
    surface.triangles = solid.triangles;
    body.solid = SolidIndex(std::move(solid));
    body.surface = SurfaceIndex(std::move(surface));
    const std::vector<double> work = slab_work(body, 1, 10);  // of 0.5 mm
    REQUIRE(work.size() == 20);
    const double voxels = 1 / std::pow(0.05, 3);
    const double walls = 4 * 10 * 0.5 * voxels, cap = 10 * 10 * 0.5 * voxels, inside = 10 * 10 * 0.5 * voxels;
    CHECK(work[10] == Approx(walls + 0.002 * inside + 0.001 * inside));
    CHECK(work[0] == Approx(walls + cap + 0.003 * inside));
    CHECK(work[19] == Approx(work[0]));
    CHECK(work[1] == Approx(work[0]));
    CHECK(work[2] == Approx(work[10]));
}

TEST_CASE("A slanting face has its work where it is wide, and one without area none", "[shards]") {
    JobBody body;
    body.grid.pitch_mm = {0.05, 0.05, 0.05};
    body.grid.size = {200, 200, 200};
    SolidMesh solid;
    for (int corner = 0; corner < 4; ++corner)
        solid.positions_mm.emplace_back(corner == 1 ? 10 : 0, corner == 2 ? 10 : 0, corner == 3 ? 10 : 0);
    solid.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    body.solid = SolidIndex(std::move(solid));
    const auto work_with = [&](std::vector<std::array<std::uint32_t, 3>> triangles) {
        VisibleSurface surface;
        // Upright, so that its shell lies beside it: widest 3 mm above the tray.
        surface.positions_mm = {{0, 5, 1}, {4, 5, 3}, {1, 5, 10}};
        surface.triangles = std::move(triangles);
        body.surface = SurfaceIndex(std::move(surface));
        return slab_work(body, 1, 10);  // of 0.5 mm
    };
    const std::vector<double> without = work_with({}), with = work_with({{0, 1, 2}, {0, 0, 1}});
    REQUIRE(with.size() == 20);
    const double widest_mm = 4 - 2.0 / 9, voxels_per_mm2 = 1 / std::pow(0.05, 3);
    for (std::size_t slab = 0; slab < 20; ++slab) {
        CAPTURE(slab);
        const double z_mm = 0.5 * (double(slab) + 0.5),
                     width_mm = widest_mm * std::max(0.0, z_mm < 3 ? (z_mm - 1) / 2 : (10 - z_mm) / 7);
        CHECK(with[slab] - without[slab] == Approx(width_mm * 0.5 * voxels_per_mm2).epsilon(0.01).margin(1e-3));
    }
}
