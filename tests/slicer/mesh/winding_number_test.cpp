// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/winding_number.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "slicer/mesh/mesh_chain.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

/// How often p lies in boxes, as their sides say; nothing on a side.
struct Box {
    Vector3d low, high;
    int sign = 1;
    [[nodiscard]] int holds(const Vector3d& p) const {
        return (p.array() > low.array()).all() && (p.array() < high.array()).all() ? sign : 0;
    }
};

}  // namespace

TEST_CASE("Winding numbers of boxes in one another add up, and those that are turned count against them") {
    const std::vector<Box> boxes{{{0, 0, 0}, {4, 4, 4}},
                                 {{1, 1, 1}, {3, 3, 3}, -1},
                                 {{2, 2, 2}, {6, 5, 7}},
                                 {{2.5, 2.5, 2.5}, {2.75, 2.75, 2.75}}};
    SolidMesh mesh;
    for (const Box& box : boxes) {
        const SolidMesh one = shapes::box(box.low, box.high);
        mesh = shapes::joined(mesh, box.sign > 0 ? one : shapes::flipped(one));
    }
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    RandomStream random(4, 4);
    for (int round = 0; round < 2000; ++round) {
        const double x = random.uniform(), y = random.uniform(), z = random.uniform();
        const Vector3d p = Vector3d(-1, -1, -1) + 9 * Vector3d(x, y, z);
        int wanted = 0;
        for (const Box& box : boxes) wanted += box.holds(p);
        CHECK(winding_number(tree, p) == wanted);
        CHECK(std::abs(winding_number(mesh.positions_mm, mesh.triangles, p) - wanted) < 1e-9);
    }
    // Where rays run along diagonals, edges and corners of faces.
    for (const double x : {0.5, 2.0, 2.625})
        for (const double y : {0.5, 2.0, 2.625})
            for (const double z : {0.5, 3.5}) {
                const Vector3d p(x, y, z);
                int wanted = 0;
                for (const Box& box : boxes) wanted += box.holds(p);
                if (x != 2.0 && y != 2.0) CHECK(winding_number(tree, p) == wanted);
            }
}

TEST_CASE("Rays through the corners of an octahedron leave the decision to its solid angle") {
    SolidMesh mesh;
    mesh.positions_mm = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    for (const double r : {0.0, 0.2, 0.9})
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                Vector3d p = Vector3d::Zero();
                p[axis] = sign * r;
                CHECK(winding_number(tree, p) == 1);
                p[axis] = sign * (r + 1.1);
                CHECK(winding_number(tree, p) == 0);
            }
}

TEST_CASE("What winding numbers look at is bounded") {
    const SolidMesh sphere = shapes::sphere(1, 20);
    const TriangleTree tree(sphere.positions_mm, sphere.triangles);
    Progress progress;
    WorkBudget little(3, &progress);
    CHECK_THROWS_AS(
        [&] {
            for (int n = 0; n < 100; ++n) (void)winding_number(tree, {0.01 * n, 0.1, 0.2}, &little);
        }(),
        WorkExceeded);
    WorkBudget enough(1'000'000, &progress);
    CHECK(winding_number(tree, {0.01, 0.1, 0.2}, &enough) == 1);
}
