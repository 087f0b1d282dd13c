// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/thin_features.h"

#include <algorithm>
#include <set>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "slicer/printer/placement.h"
#include "tests/slicer/mesh/shapes.h"
#include "voxel_parts.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

struct Thin {
    VoxelGrid grid;
    SpanSlab base, kept;
    std::uint64_t added = 0;

    explicit Thin(const SolidMesh& mesh, const Vector3d& pitch = Vector3d::Ones()) {
        Vector3d low = mesh.positions_mm[0], high = low;
        for (const Vector3d& p : mesh.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
        grid = grid_around(low, high, pitch);
        const Solid solid(mesh, grid);
        const SolidIndex index(mesh);
        const ThinFeatures thin(index, solid);
        base = solid.slab(0, grid.size[2]);
        added = thin.slab(0, grid.size[2], kept);
        // Any split gives the same.
        std::uint64_t added_in_parts = 0;
        for (int step : {1, 7})
            for (int k = 0; k < grid.size[2]; k += step) {
                SpanSlab part;
                const std::uint64_t n = thin.slab(k, std::min(k + step, grid.size[2]), part);
                if (step == 1) added_in_parts += n;
                for (int l = part.k_begin(); l < part.k_end(); ++l)
                    for (int j = 0; j < grid.size[1]; ++j) {
                        const auto a = part.row(j, l), b = kept.row(j, l);
                        REQUIRE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
                    }
            }
        CHECK(added_in_parts == added);
        CHECK(voxels_of(kept).size() == voxels_of(base).size() + added);
    }
    [[nodiscard]] bool reaches(const Vector3d& p) const {
        const Vector3d at = (p - grid.origin_mm).cwiseQuotient(grid.pitch_mm);
        for (int n = 0; n < 27; ++n) {
            const int i = int(std::floor(at[0])) + n % 3 - 1, j = int(std::floor(at[1])) + n / 3 % 3 - 1,
                      k = int(std::floor(at[2])) + n / 9 - 1;
            if (j >= 0 && j < grid.size[1] && k >= 0 && k < grid.size[2] && kept.contains(i, j, k)) return true;
        }
        return false;
    }
};

Eigen::Affine3d turn(RandomStream& random) {
    const Vector3d axis(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    return Eigen::Affine3d(Eigen::AngleAxisd(6.28 * random.uniform(), axis.normalized()));
}

const Vector3d j750(0.0423333, 0.0846667, 0.027);

}  // namespace

TEST_CASE("Plates thinner than a voxel stay whole at any angle") {
    RandomStream random(21, 0);
    int pieces_without = 0;
    for (int n = 0; n < 30; ++n) {
        const double thickness = n % 3 == 0 ? 0.05 : n % 3 == 1 ? 0.3 : 0.8;
        const SolidMesh plate = shapes::box({0, 0, 0}, {17, 13, thickness});
        const Thin thin(n < 3 ? shapes::moved(plate, Vector3d(0.1, 0.1, 0.55)) : shapes::moved(plate, turn(random)));
        CAPTURE(n);
        CHECK(parts(voxels_of(thin.kept)) == 1);
        pieces_without += parts(voxels_of(thin.base)) != 1;
        // No thicker than it must be: a 26-connected plane has at most as many voxels as the lines of three axes that
        // meet it.
        CHECK(double(voxels_of(thin.kept).size()) < 17 * 13 * (1.75 + thickness * 1.75) + 4 * 30);
    }
    CHECK(pieces_without > 15);
    // On a real printer's voxels.
    for (int n = 0; n < 10; ++n) {
        const Thin thin(shapes::moved(shapes::box({0, 0, 0}, {0.9, 0.7, 0.012}), turn(random)), j750);
        CHECK(parts(voxels_of(thin.kept)) == 1);
    }
}

TEST_CASE("Wires thinner than a voxel stay whole at any angle") {
    RandomStream random(22, 0);
    int pieces_without = 0;
    for (int n = 0; n < 40; ++n) {
        const double a = n % 2 ? 0.1 : 0.6, b = n % 3 ? 0.2 : 0.7;
        const Eigen::Affine3d by = n == 0 ? Eigen::Affine3d::Identity() : turn(random);
        const bool printer = n % 4 == 3;
        const Vector3d pitch = printer ? j750 : Vector3d(Vector3d::Ones());
        const double scale = printer ? 0.03 : 1;
        const Thin thin(shapes::moved(shapes::box({0, 0, 0}, scale * Vector3d(a, b, 25)), by), pitch);
        CAPTURE(n);
        CHECK(parts(voxels_of(thin.kept)) == 1);
        CHECK(thin.reaches(by * (scale * Vector3d(a / 2, b / 2, 0.5))));
        CHECK(thin.reaches(by * (scale * Vector3d(a / 2, b / 2, 24.5))));
        pieces_without += parts(voxels_of(thin.base)) != 1;
    }
    CHECK(pieces_without > 30);

    // A ring of fine wire, of many small faces.
    for (int n = 0; n < 6; ++n) {
        const Eigen::Affine3d by = turn(random);
        const Thin ring(shapes::moved(shapes::torus(9, 0.1 + 0.06 * n, 60, 6), by));
        CAPTURE(n);
        CHECK(parts(voxels_of(ring.kept)) == 1);
        CHECK(ring.added > 10);
        for (int s = 0; s < 60; ++s) {
            const double a = 2 * std::numbers::pi * s / 60;
            CHECK(ring.reaches(by * Vector3d(9 * std::cos(a), 9 * std::sin(a), 0)));
        }
    }
}

TEST_CASE("What is thin and stands out of the grid, which is rounded to its body, is kept in the last voxels") {
    // 8.45 voxels are printed as 8: the body's ends lie 0.225 voxel outside.
    for (int axis = 0; axis < 3; ++axis)
        for (const Vector3d& fin : {Vector3d(0.05, 6, 6), Vector3d(0.05, 0.05, 6), Vector3d(0.05, 6, 0.05)})
            for (const bool low : {false, true}) {
                CAPTURE(axis, low, fin.transpose());
                const Vector3d corner(low ? 0 : 8.4, 1.2, 1.2), core(low ? 4.45 : 0, 0, 0);
                const auto along = [&](const Vector3d& p) {
                    return Vector3d(p[(3 - axis) % 3], p[(4 - axis) % 3], p[(5 - axis) % 3]);
                };
                const Thin thin(shapes::joined(shapes::box(along(core), along(core + Vector3d(4, 8, 8))),
                                               shapes::box(along(corner), along(corner + fin))));
                REQUIRE(thin.grid.size == std::array<int, 3>{8, 8, 8});
                CHECK(thin.reaches(along(corner + fin / 2)));
                CHECK(parts(voxels_of(thin.base)) == 1);
                CHECK(parts(voxels_of(thin.kept)) == 2);
            }
}

TEST_CASE("A speck smaller than a voxel becomes a voxel") {
    VoxelGrid grid;
    grid.size = {5, 5, 5};
    for (const Vector3d& at : {Vector3d(2.2, 2.2, 2.2), Vector3d(2.0, 2.0, 2.0), Vector3d(1.9, 3.1, 2.4)}) {
        const SolidMesh speck = shapes::moved(shapes::sphere(0.15, 4), at);
        const Solid solid(speck, grid);
        SpanSlab kept;
        const std::uint64_t added = ThinFeatures(SolidIndex(speck), solid).slab(0, 5, kept);
        CHECK(voxels_of(solid.slab(0, 5)).empty());
        CHECK(added >= 1);
        CHECK(parts(voxels_of(kept)) == 1);
    }
}

TEST_CASE("Thick bodies do not grow, and gaps between bodies stay open") {
    CHECK(Thin(shapes::sphere(9, 30)).added == 0);
    CHECK(Thin(shapes::moved(shapes::torus(9, 3, 40, 20), shapes::tilt())).added == 0);
    CHECK(Thin(shapes::box({0, 0, 0}, {9, 8, 7})).added == 0);
    CHECK(Thin(shapes::box({0.2, 0.3, 0.7}, {9.1, 8.6, 7.9})).added == 0);
    RandomStream random(23, 0);
    for (int n = 0; n < 10; ++n)
        CHECK(Thin(shapes::moved(shapes::box({0, 0, 0}, {11, 12, 13}), turn(random))).added <= 8);  // corners
    // 0.7 voxel apart, with one row of centres or none between.
    for (double shift : {0.0, 0.3, 0.6}) {
        SolidMesh pair =
            shapes::joined(shapes::box({0, 0, 0}, {5 + shift, 9, 9}), shapes::box({5.7 + shift, 0, 0}, {11, 9, 9}));
        CHECK(Thin(pair).added == 0);
    }
}

namespace {

/// The square [0, 1] x [0, 1] drawn along z from 0 to `length`, leaning by so much along x and y for each voxel of it:
/// a wire that holds one voxel centre in every layer. `axis`: which axis it is drawn along instead.
SolidMesh leaning_wire(double lean_x, double lean_y, double length, int axis) {
    SolidMesh wire = shapes::box({0.31, 0.17, 0}, {1.31, 1.17, length});
    for (Vector3d& p : wire.positions_mm) {
        p += p.z() * Vector3d(lean_x, lean_y, 0);
        p = axis == 0 ? Vector3d(p.z(), p.x(), p.y()) : axis == 1 ? Vector3d(p.y(), p.z(), p.x()) : p;
    }
    return wire;
}

}  // namespace

TEST_CASE("A wire that is a chain of voxels already, each touching the next, gets none more") {
    for (int axis = 0; axis < 3; ++axis)
        for (const double lean_x : {0.0, 0.13, -0.37, 0.55})
            for (const double lean_y : {0.0, 0.07, -0.29, 0.61}) {
                CAPTURE(axis, lean_x, lean_y);
                const Thin thin(leaning_wire(lean_x, lean_y, 20, axis));
                // One centre a layer, and the next layer's beside or above it: nothing is missing.
                REQUIRE(voxels_of(thin.base).size() == 20);
                REQUIRE(parts(voxels_of(thin.base)) == 1);
                CHECK(thin.added == 0);
            }
}

TEST_CASE("Square wires thinner than a voxel's diagonal stay whole, wider than its least side or not") {
    RandomStream random(24, 0);
    int pieces_without = 0;
    for (int n = 0; n < 60; ++n) {
        const bool printer = n % 2;
        // Of a printer's voxel the least side has 0.027 mm and the diagonal 0.098.
        const double side = printer ? (n % 4 == 1 ? 0.035 : 0.05) : 0.85, length = printer ? 1.2 : 20;
        const Thin thin(shapes::moved(shapes::box({0, 0, 0}, {side, side, length}), turn(random)),
                        printer ? j750 : Vector3d(Vector3d::Ones()));
        CAPTURE(n);
        CHECK(parts(voxels_of(thin.kept)) == 1);
        pieces_without += parts(voxels_of(thin.base)) != 1;
    }
    CHECK(pieces_without > 40);
}

TEST_CASE("Needles of four corners stay whole, whose opposite faces share corners with their edges") {
    RandomStream random(25, 0);
    int pieces_without = 0;
    for (int n = 0; n < 40; ++n) {
        const double width = n % 2 ? 0.7 : 1.1;
        SolidMesh needle;
        needle.positions_mm = {{0, 0, 0}, {width, 0, 0}, {width / 2, -width / 2, 22}, {width / 2, width / 2, 22}};
        needle.triangles = {{0, 3, 1}, {0, 1, 2}, {0, 2, 3}, {1, 3, 2}};
        const Eigen::Affine3d by = turn(random);
        const Thin thin(shapes::moved(shapes::with_sources(needle), by));
        CAPTURE(n);
        CHECK(parts(voxels_of(thin.kept)) == 1);
        CHECK(thin.reaches(by * Vector3d(width / 2, 0, 11)));
        pieces_without += parts(voxels_of(thin.base)) != 1;
    }
    CHECK(pieces_without > 20);
}

TEST_CASE("Rows of more than 64 voxels are looked at like short ones") {
    for (const double lean_x : {0.0, 0.13, -0.21})
        for (const double lean_y : {0.07, -0.18}) {
            CAPTURE(lean_x, lean_y);
            const Thin chain(leaning_wire(lean_x, lean_y, 140, 0));
            REQUIRE(voxels_of(chain.base).size() == 140);
            CHECK(chain.added == 0);
        }
    CHECK(Thin(shapes::box({0.3, 0.4, 0.2}, {139.8, 6.1, 5.3})).added == 0);
    // A fine wire on a block, in front of and behind each border of 64.
    for (const double x : {62.1, 63.4, 64.2, 127.3, 128.8}) {
        CAPTURE(x);
        const Thin thin(shapes::joined(shapes::box({0, 0, 0}, {140, 4, 3}),
                                       shapes::moved(shapes::box({0, 0, 0}, {0.2, 0.2, 9}), Vector3d(x, 1.1, 2.5))));
        CHECK(parts(voxels_of(thin.kept)) == 1);
        CHECK((thin.added >= 8 && thin.added <= 18));
        CHECK(thin.reaches({x, 1.2, 11}));
        for (const auto& voxel : voxels_of(thin.kept))
            if (voxel[2] >= 4) CHECK(std::abs(voxel[0] + 0.5 - x) < 1.6);
    }
}

TEST_CASE("A plate along the grid gets one voxel for each line through it, and no more") {
    // Between the centres of voxel 2 and 3 of its axis, 5 x 7 voxels, a little off their borders.
    for (int axis = 0; axis < 3; ++axis) {
        CAPTURE(axis);
        Vector3d low, high;
        low[axis] = 2.6, high[axis] = 2.9;
        low[(axis + 1) % 3] = 0.1, high[(axis + 1) % 3] = 4.9;
        low[(axis + 2) % 3] = 0.1, high[(axis + 2) % 3] = 6.9;
        const SolidMesh plate = shapes::box(low, high);
        VoxelGrid grid;
        grid.size = {8, 8, 8};
        const Solid solid(plate, grid);
        SpanSlab kept;
        const std::uint64_t added = ThinFeatures(SolidIndex(plate), solid).slab(0, 8, kept);
        CHECK(voxels_of(solid.slab(0, 8)).empty());
        CHECK(added == 5 * 7);
        for (const auto& voxel : voxels_of(kept)) CHECK(voxel[std::size_t(axis)] == 2);
    }
}
