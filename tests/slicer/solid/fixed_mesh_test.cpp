// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/fixed_mesh.h"

#include <algorithm>
#include <set>

#include <catch2/catch.hpp>

#include "tests/slicer/mesh/shapes.h"

using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

VoxelGrid grid_of(std::array<int, 3> size) {
    VoxelGrid grid;
    grid.origin_mm = {1, -2, 3};
    grid.pitch_mm = {0.5, 0.25, 0.125};
    grid.size = size;
    return grid;
}

}  // namespace

TEST_CASE("Quotients are rounded up on either side of nothing") {
    CHECK(ceil_div(7, 2) == 4);
    CHECK(ceil_div(6, 2) == 3);
    CHECK(ceil_div(-7, 2) == -3);
    CHECK(ceil_div(-6, 2) == -3);
    CHECK(ceil_div(0, 5) == 0);
}

TEST_CASE("A fixed mesh has whole numbers at the middles of voxels") {
    const VoxelGrid grid = grid_of({10, 20, 30});
    SolidMesh mesh;
    mesh.positions_mm = {grid.centre(0, 0, 0), grid.centre(3, 7, 11), grid.origin_mm, grid.centre(9, 19, 29)};
    mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
    const FixedMesh fixed(mesh, grid);
    CHECK(fixed.fraction_bits == 16);
    const std::int32_t one = 1 << 16;
    CHECK(fixed.vertices[0] == FixedMesh::Vertex{0, 0, 0});
    CHECK(fixed.vertices[1] == FixedMesh::Vertex{3 * one, 7 * one, 11 * one});
    CHECK(fixed.vertices[2] == FixedMesh::Vertex{-one / 2, -one / 2, -one / 2});
    CHECK(fixed.vertices[3] == FixedMesh::Vertex{9 * one, 19 * one, 29 * one});
    CHECK(fixed.triangles == mesh.triangles);
}

TEST_CASE("A large mesh is rounded more coarsely, so that differences stay below 2^30") {
    for (const int size : {16000, 16380, 16390, 40000, 1 << 20}) {
        CAPTURE(size);
        const VoxelGrid grid = grid_of({size, 4, 4});
        SolidMesh mesh;
        mesh.positions_mm = {grid.centre(0, 0, 0), grid.centre(size - 1, 1, 1), grid.centre(5, 3, 2)};
        mesh.triangles = {{0, 1, 2}};
        const FixedMesh fixed(mesh, grid);
        CHECK(fixed.vertices[1][0] == std::int64_t{size - 1} << fixed.fraction_bits);
        CHECK(fixed.vertices[2] ==
              FixedMesh::Vertex{5 << fixed.fraction_bits, 3 << fixed.fraction_bits, 2 << fixed.fraction_bits});
        CHECK(std::ldexp(size + 2.0, fixed.fraction_bits) <= 0x1p30);
        CHECK((fixed.fraction_bits == 16 || std::ldexp(size + 2.0, fixed.fraction_bits + 1) > 0x1p30));
    }
}

TEST_CASE("Every triangle is found by the layers that it meets, once in each piece") {
    const VoxelGrid grid = grid_of({8, 8, 50});
    SolidMesh mesh = shapes::sphere(2.0, 9);
    const Vector3d middle = grid.origin_mm + Vector3d(2, 1, 3);
    for (Vector3d& p : mesh.positions_mm) p = middle + Vector3d(p.x(), p.y(), 2 * p.z());  // beyond the grid, both ends
    // A triangle flat in the middle of a layer where pieces begin, and one outside of all layers.
    const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
    for (const int k : {16, 60})
        for (const Vector3d& p : {grid.centre(1, 1, k), grid.centre(3, 1, k), grid.centre(1, 3, k)})
            mesh.positions_mm.push_back(p);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 3, first + 4, first + 5});
    const FixedMesh fixed(mesh, grid);
    for (const auto& [begin, past_last] : {std::pair{0, 50}, std::pair{3, 17}, std::pair{16, 32}, std::pair{40, 41}}) {
        const int end = past_last;
        CAPTURE(begin, end);
        std::set<std::pair<int, std::uint32_t>> found;
        int at = begin;
        bool in_order = true;
        fixed.for_each_triangle(begin, end, [&, end](std::uint32_t t, int k, int past) {
            in_order = in_order && k >= at && past > k && past <= end && past - k <= FixedMesh::bucket_layers;
            at = k;
            for (int layer = k; layer < past; ++layer) CHECK(found.emplace(layer, t).second);
        });
        CHECK(in_order);
        bool all = true;
        for (int k = begin; k < end; ++k)
            for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
                double low = 1e9, high = -1e9;
                for (const std::uint32_t v : mesh.triangles[t]) {
                    const double z = (mesh.positions_mm[v].z() - grid.origin_mm.z()) / grid.pitch_mm.z() - 0.5;
                    low = std::min(low, z), high = std::max(high, z);
                }
                const bool meets = low <= k + 1 && high >= k;  // the layer, or the space up to the next
                if (meets) all = all && found.contains({k, t});
            }
        CHECK(all);
        const auto outside = static_cast<std::uint32_t>(mesh.triangles.size() - 1);
        CHECK(std::none_of(found.begin(), found.end(), [&](const auto& entry) { return entry.second == outside; }));
    }
}
