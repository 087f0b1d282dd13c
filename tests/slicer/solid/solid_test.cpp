// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/solid.h"

#include <catch2/catch.hpp>

#include "base/contracts.h"
#include "base/random.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

VoxelGrid grid_around(const SolidMesh& mesh, const Vector3d& pitch, const Vector3d& shift = Vector3d::Zero()) {
    Vector3d low = mesh.positions_mm[0], high = low;
    for (const Vector3d& p : mesh.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
    VoxelGrid grid;
    grid.pitch_mm = pitch;
    grid.origin_mm = low - pitch.cwiseProduct(shift) - pitch;
    for (int a = 0; a < 3; ++a) grid.size[a] = int(std::ceil((high[a] - grid.origin_mm[a]) / pitch[a])) + 1;
    return grid;
}

std::uint64_t voxels(const SpanSlab& slab) {
    std::uint64_t n = 0;
    for (int k = slab.k_begin(); k < slab.k_end(); ++k) n += slab.voxels_of_layer(k);
    return n;
}

}  // namespace

TEST_CASE("A box takes exactly the voxels whose centres it holds") {
    VoxelGrid grid;
    grid.pitch_mm = {0.5, 0.25, 0.125};
    grid.size = {10, 12, 14};
    // From 2.2 to 7.4 voxels along x: centres 2.5 to 6.5; the upper z face lies on centres, which are then outside.
    const Solid solid(shapes::box(grid.pitch_mm.cwiseProduct(Vector3d(2.2, 3.6, 0.4)),
                                  grid.pitch_mm.cwiseProduct(Vector3d(7.4, 9.6, 13.5))),
                      grid);
    const SpanSlab slab = solid.slab(0, 14);
    for (int k = 0; k < 14; ++k)
        for (int j = 0; j < 12; ++j)
            for (int i = 0; i < 10; ++i)
                REQUIRE(slab.contains(i, j, k) == (i >= 2 && i <= 6 && j >= 4 && j <= 9 && k <= 12));
    CHECK(solid.winding_volume_mm3() == Approx(5.2 * 6 * 13.1 * grid.voxel_volume_mm3()).epsilon(1e-4));
}

TEST_CASE("Faces on voxel centres: boxes side by side share no voxel and leave none out") {
    VoxelGrid grid;
    grid.size = {9, 9, 9};
    const auto box = [](double x0, double x1, double y0, double y1, double z0, double z1) {
        return shapes::box({x0, y0, z0}, {x1, y1, z1});
    };
    // Eight boxes that meet in the centre of voxel (4, 4, 4); outer faces on centres too.
    int count[9][9][9] = {};
    for (int c = 0; c < 8; ++c) {
        const auto range = [](bool upper) { return upper ? std::pair{4.5, 7.5} : std::pair{1.5, 4.5}; };
        const auto [x0, x1] = range(c & 1);
        const auto [y0, y1] = range(c & 2);
        const auto [z0, z1] = range(c & 4);
        const SpanSlab slab = Solid(box(x0, x1, y0, y1, z0, z1), grid).slab(0, 9);
        CHECK(voxels(slab) == 27);
        for (int k = 0; k < 9; ++k)
            for (int j = 0; j < 9; ++j)
                for (int i = 0; i < 9; ++i) count[i][j][k] += slab.contains(i, j, k);
    }
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j)
            for (int k = 0; k < 9; ++k)
                CHECK(count[i][j][k] == (std::min({i, j, k}) >= 1 && std::max({i, j, k}) < 7 ? 1 : 0));
}

TEST_CASE("Nested and overlapping shells are a union, cavities and inverted bodies go by the winding number") {
    VoxelGrid grid;
    grid.size = {20, 12, 12};
    const auto at = [&](const SolidMesh& m) { return voxels(Solid(m, grid).slab(0, 12)); };
    const SolidMesh a = shapes::box({1, 1, 1}, {9, 11, 11}), inner = shapes::box({3, 3, 3}, {7, 8, 8});
    const SolidMesh overlap = shapes::box({5, 1, 1}, {15, 11, 11}), apart = shapes::box({16, 1, 1}, {18, 3, 3});
    CHECK(at(a) == 800);
    CHECK(at(shapes::joined(a, inner)) == 800);
    CHECK(at(shapes::joined(a, shapes::flipped(inner))) == 800 - 100);
    CHECK(at(shapes::joined(a, overlap)) == 1400);
    CHECK(at(shapes::joined(a, apart)) == 808);
    CHECK(at(shapes::flipped(a)) == 800);
    CHECK(Solid(shapes::flipped(a), grid).winding_volume_mm3() == Approx(-800));
}

TEST_CASE("Volume and layer areas agree with the mesh within the error of outline and pitch") {
    const Vector3d pitch(0.0423333, 0.0846667, 0.027);
    const auto shape = GENERATE(0, 1, 2, 3);
    const SolidMesh mesh = shape == 0   ? shapes::sphere(1.3, 24)
                           : shape == 1 ? shapes::moved(shapes::torus(1.2, 0.5, 48, 24), shapes::tilt())
                           : shape == 2 ? shapes::moved(shapes::box({-1, -0.7, -1.3}, {1.1, 0.9, 0.8}), shapes::tilt())
                                        : shapes::box({-1, -0.7, -1.3}, {1.1, 0.9, 0.8});
    const VoxelGrid grid = grid_around(mesh, pitch, {0.3, 0.7, 0.4});
    const Solid solid(mesh, grid);
    CHECK(solid.winding_volume_mm3() == Approx(shapes::volume(mesh)).epsilon(1e-5));
    const SpanSlab slab = solid.slab(0, grid.size[2]);
    const double voxel_area = pitch[0] * pitch[1], diagonal = std::hypot(pitch[0], pitch[1]);
    double area_sum = 0, outline_sum = 0;
    for (int k = 0; k < grid.size[2]; ++k) {
        const shapes::Cut cut = shapes::cut(mesh, grid.centre(0, 0, k)[2]);
        // A wrong part of a pixel lies within half a diagonal of the outline, on either side.
        const double error = double(slab.voxels_of_layer(k)) * voxel_area - cut.area;
        REQUIRE(std::abs(error) <= diagonal * cut.outline + 1e-12);
        area_sum += error;
        outline_sum += cut.outline;
    }
    if (shape == 3) return;  // its faces lie along the grid: errors do not average out
    // Crossings fall at random within a pixel: each row adds two errors of variance pitch_x^2 / 12 at most, and
    // outlines that run along x as much in the other direction; outline / min(pitch) bounds their number. Five standard
    // deviations.
    const double errors = outline_sum / std::min(pitch[0], pitch[1]);
    CHECK(std::abs(area_sum) <= 5 * voxel_area * std::sqrt(errors / 12) + 1e-12);
}

TEST_CASE("Any split into slabs gives the same layers") {
    const SolidMesh mesh =
        shapes::joined(shapes::moved(shapes::torus(1.2, 0.5, 30, 20), shapes::tilt()), shapes::sphere(0.9, 12));
    const VoxelGrid grid = grid_around(mesh, {0.05, 0.08, 0.03});
    const Solid solid(mesh, grid);
    const SpanSlab whole = solid.slab(0, grid.size[2]);
    for (int thickness : {1, 5, 16, 23})
        for (int k = 0; k < grid.size[2]; k += thickness) {
            const SpanSlab part = solid.slab(k, std::min(k + thickness, grid.size[2]));
            for (int l = part.k_begin(); l < part.k_end(); ++l)
                for (int j = 0; j < grid.size[1]; ++j) {
                    const auto a = part.row(j, l), b = whole.row(j, l);
                    REQUIRE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
                }
        }
    CHECK(voxels(whole) > 0);
}

TEST_CASE("Random closed chains agree with the winding number, on and off the lattice") {
    // Sums of tetrahedra of either orientation, and one surface with displaced vertices: self-crossing, overlapping.
    const bool on_lattice = GENERATE(true, false);
    for (std::uint64_t round = 0; round < 40; ++round) {
        RandomStream random(17, round, on_lattice);
        const auto coordinate = [&] {
            // Halves of a voxel put vertices, edges and faces on centres; otherwise exact multiples of the lattice.
            return on_lattice ? 0.5 * std::floor(random.uniform() * 15 + 1)
                              : std::floor((random.uniform() * 7 + 0.5) * 65536) / 65536;
        };
        SolidMesh mesh;
        if (round % 2) {
            mesh = shapes::sphere(1, 4);
            for (auto& p : mesh.positions_mm) p = {coordinate(), coordinate(), coordinate()};
        } else {
            for (std::uint32_t t = 0; t < 5; ++t) {
                for (int c = 0; c < 4; ++c) mesh.positions_mm.emplace_back(coordinate(), coordinate(), coordinate());
                const std::uint32_t a = 4 * t;
                for (auto f :
                     {std::array{a, a + 1, a + 2}, {a, a + 3, a + 1}, {a + 1, a + 3, a + 2}, {a, a + 2, a + 3}})
                    mesh.triangles.push_back(f);
            }
        }
        VoxelGrid grid;
        grid.size = {8, 8, 8};
        const SpanSlab slab = Solid(mesh, grid).slab(0, 8);
        // On the lattice the infinitesimal step, small enough against the coefficients of any plane through such
        // points; off it no centre lies on the surface.
        const Vector3d step = on_lattice ? Vector3d(0x1p-12, 0x1p-24, 0x1p-36) : Vector3d(0, 0, 0);
        for (int k = 0; k < 8; ++k)
            for (int j = 0; j < 8; ++j)
                for (int i = 0; i < 8; ++i) {
                    CAPTURE(round, i, j, k);
                    REQUIRE(slab.contains(i, j, k) == (shapes::winding_number(mesh, grid.centre(i, j, k) + step) != 0));
                }
    }
}

TEST_CASE("A surface beyond the grid is clipped, and large grids keep to 64 bits") {
    VoxelGrid grid;
    grid.size = {4, 5, 6};
    CHECK(voxels(Solid(shapes::box({-3, -3, -3}, {9, 9, 9}), grid).slab(0, 6)) == 120);
    CHECK(voxels(Solid(shapes::box({-3, 2, -30}, {2, 9, 90}), grid).slab(0, 6)) == 2 * 3 * 6);
    CHECK(voxels(Solid(shapes::box({5, 2, 1}, {8, 9, 9}), grid).slab(0, 6)) == 0);
    grid.size = {65000, 60000, 3};
    const SpanSlab slab =
        Solid(shapes::moved(shapes::box({-30000.25, -29000.25, -5}, {30000, 29000, 5}), Vector3d(32000, 30000, 1)),
              grid)
            .slab(1, 2);
    CHECK(voxels(slab) == 60000ull * 58000ull);
}

TEST_CASE("An open surface breaks the contract") {
    SolidMesh mesh = shapes::box({1, 1, 1}, {4, 4, 4});
    mesh.triangles.pop_back();
    VoxelGrid grid;
    grid.size = {5, 5, 5};
    CHECK_THROWS_AS(Solid(mesh, grid).slab(0, 5), ContractViolation);
}
