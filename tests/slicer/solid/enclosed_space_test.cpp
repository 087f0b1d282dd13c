// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/enclosed_space.h"

#include <set>

#include <catch2/catch.hpp>

#include "slicer/mesh/mesh_chain.h"
#include "slicer/solid/triangle_cell.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

SolidMesh hollow_box(double wall) {
    return shapes::joined(shapes::box({0, 0, 0}, {12, 10, 8}),
                          shapes::flipped(shapes::box({wall, wall, wall}, {12 - wall, 10 - wall, 8 - wall})));
}

/// The same with a square channel of this width through the wall at x = 0, from the void's middle outward.
SolidMesh with_channel(double wall, double width) {
    const Vector3d middle(0, 5, 4);
    SolidMesh mesh;
    const auto square = [&](double x, double half_y, double half_z) {
        const auto first = std::uint32_t(mesh.positions_mm.size());
        for (const auto& [y, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
            mesh.positions_mm.emplace_back(x, middle[1] + y * half_y, middle[2] + z * half_z);
        return first;
    };
    const auto band = [&](std::uint32_t outer, std::uint32_t inner) {  // seen from -x: outer square around inner
        for (std::uint32_t c = 0; c < 4; ++c) {
            const std::uint32_t n = (c + 1) % 4;
            mesh.triangles.push_back({outer + c, inner + n, outer + n});
            mesh.triangles.push_back({outer + c, inner + c, inner + n});
        }
    };
    const std::uint32_t near = square(0, 5, 4), hole = square(0, width / 2, width / 2),
                        hole_in = square(wall, width / 2, width / 2), near_in = square(wall, 5 - wall, 4 - wall),
                        far_in = square(12 - wall, 5 - wall, 4 - wall), far = square(12, 5, 4);
    band(near, hole), band(hole, hole_in), band(hole_in, near_in), band(near_in, far_in), band(far, near);
    mesh.triangles.push_back({far_in, far_in + 2, far_in + 1});
    mesh.triangles.push_back({far_in, far_in + 3, far_in + 2});
    mesh.triangles.push_back({far, far + 1, far + 2});
    mesh.triangles.push_back({far, far + 2, far + 3});
    return shapes::with_sources(mesh);
}

}  // namespace

TEST_CASE("A cube and a triangle meet or do not, as an edge that passes by shows", "[cavities]") {
    using P = std::array<Vector3d, 3>;
    CHECK(triangle_meets_cube(P{Vector3d(-3, 0, 0), Vector3d(3, 0, 0), Vector3d(0, 3, 0)}, 0.5));
    CHECK(triangle_meets_cube(P{Vector3d(-9, -9, 0.5), Vector3d(9, -9, 0.5), Vector3d(0, 9, 0.5)}, 0.5));
    CHECK_FALSE(triangle_meets_cube(P{Vector3d(-9, -9, 0.51), Vector3d(9, -9, 0.51), Vector3d(0, 9, 0.51)}, 0.5));
    // All boxes overlap here; an edge's cross product tells.
    CHECK_FALSE(triangle_meets_cube(P{Vector3d(1.2, 0, -4), Vector3d(0, 1.2, 4), Vector3d(3, 3, 0)}, 0.5));
    CHECK(triangle_meets_cube(P{Vector3d(0.9, 0, -4), Vector3d(0, 0.9, 4), Vector3d(3, 3, 0)}, 0.5));
    // The plane of a slanted one passes a corner.
    CHECK_FALSE(triangle_meets_cube(P{Vector3d(1.6, 0, 0), Vector3d(0, 1.6, 0), Vector3d(0, 0, 1.6)}, 0.5));
    CHECK(triangle_meets_cube(P{Vector3d(1.4, 0, 0), Vector3d(0, 1.4, 0), Vector3d(0, 0, 1.4)}, 0.5));
}

TEST_CASE("A large slanting triangle touches about as many cells as it has area, and misses none", "[cavities]") {
    const std::array<Vector3d, 3> p{Vector3d(0.3, 0.2, 0.1), Vector3d(40.2, 11.7, 3.3), Vector3d(7.7, 35.1, 28.4)};
    std::set<std::array<int, 3>> cells;
    for_each_cell_of_triangle(p, [&](int i, int j, int k) { cells.insert({i, j, k}); });
    const double area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    CHECK(double(cells.size()) > area);
    CHECK(double(cells.size()) < 3 * area);
    std::size_t missed = 0;
    for (int u = 0; u <= 400; ++u)
        for (int v = 0; u + v <= 400; ++v) {
            const Vector3d at = p[0] + (p[1] - p[0]) * u / 400 + (p[2] - p[0]) * v / 400;
            missed += !cells.count({int(std::floor(at[0])), int(std::floor(at[1])), int(std::floor(at[2]))});
        }
    CHECK(missed == 0);
}

TEST_CASE("A shell within a shell shuts a void off, two bodies and a solid one do not", "[cavities]") {
    const EnclosedSpace space(hollow_box(1));
    REQUIRE(space.voids().size() == 1);
    CHECK(space.at({6, 5, 4}) == EnclosedSpace::first_void);
    CHECK(space.at({0.5, 5, 4}) == EnclosedSpace::wall);
    CHECK(space.at({-1, 5, 4}) == EnclosedSpace::outside);
    CHECK(space.at({1e9, 0, 0}) == EnclosedSpace::outside);
    // 10 x 8 x 6 mm less a row of cells along each wall, at most.
    CHECK(space.voids()[0].cells_mm3 <= 480);
    CHECK(space.voids()[0].cells_mm3 >= 9.25 * 7.25 * 5.25);
    CHECK((space.voids()[0].centre_mm - Vector3d(6, 5, 4)).norm() < 0.3);
    CHECK(space.at(space.voids()[0].inside_mm) == EnclosedSpace::first_void);

    CHECK(EnclosedSpace(shapes::box({0, 0, 0}, {9, 9, 9})).voids().empty());
    CHECK(EnclosedSpace(shapes::joined(shapes::box({0, 0, 0}, {9, 9, 9}), shapes::box({1, 1, 1}, {8, 8, 8})))
              .voids()
              .empty());
    CHECK(EnclosedSpace(shapes::torus(6, 2, 60, 30)).voids().empty());
    // Walls thinner than anything.
    CHECK(EnclosedSpace(hollow_box(1e-4)).voids().size() == 1);
}

TEST_CASE("Voids come by their size, small ones are pockets", "[cavities]") {
    SolidMesh mesh = shapes::box({0, 0, 0}, {20, 10, 10});
    mesh = shapes::joined(mesh, shapes::flipped(shapes::box({1, 1, 1}, {3, 3, 3})));
    mesh = shapes::joined(mesh, shapes::flipped(shapes::box({5, 1, 1}, {12, 9, 9})));
    mesh = shapes::joined(mesh, shapes::flipped(shapes::box({15, 1, 1}, {15.9, 1.9, 1.9})));
    const EnclosedSpace space(mesh);
    REQUIRE(space.voids().size() == 2);
    CHECK(space.at({8, 5, 5}) == EnclosedSpace::first_void);
    CHECK(space.at({2, 2, 2}) == EnclosedSpace::first_void + 1);
    CHECK(space.at({15.45, 1.45, 1.45}) == EnclosedSpace::pocket);
    EnclosureOptions finer;
    finer.smallest_mm3 = 0.01;
    CHECK(EnclosedSpace(mesh, finer).voids().size() == 3);
    // By its volume, however small the cells are.
    finer.cell_mm = 0.15;
    finer.smallest_mm3 = 3;
    CHECK(EnclosedSpace(mesh, finer).voids().size() == 2);
    finer.smallest_mm3 = 9;
    CHECK(EnclosedSpace(mesh, finer).voids().size() == 1);
}

TEST_CASE("What is narrower than a cell is no way in, what is wider than three is", "[cavities]") {
    REQUIRE(open_edges(with_channel(1, 0.24).triangles) == 0);
    for (const double wall : {0.12, 1.0, 2.0}) {
        CAPTURE(wall);
        CHECK(EnclosedSpace(with_channel(wall, 0.05)).voids().size() == 1);
        CHECK(EnclosedSpace(with_channel(wall, 0.24)).voids().size() == 1);
        CHECK(EnclosedSpace(with_channel(wall, 0.76)).voids().empty());
        CHECK(EnclosedSpace(with_channel(wall, 3)).voids().empty());
    }
}

TEST_CASE("A closing shuts wider ways in, as its cells say", "[cavities]") {
    EnclosureOptions closing;
    closing.cell_mm = 0.5, closing.closing = 3;  // 3.5 mm
    for (const double wall : {0.3, 1.0}) {
        CAPTURE(wall);
        const EnclosedSpace space(with_channel(wall, 3), closing);
        REQUIRE(space.voids().size() == 1);
        // Grown back up to the walls.
        CHECK(space.voids()[0].cells_mm3 > 0);
        CHECK(space.at({11.9 - wall - 0.5, 9.9 - wall - 0.5, 4}) == EnclosedSpace::first_void);
        CHECK(EnclosedSpace(with_channel(wall, 4.6), closing).voids().empty());
    }
    // Between two bodies as far apart as that nothing is shut.
    CHECK(EnclosedSpace(shapes::joined(shapes::box({0, 0, 0}, {3, 9, 9}), shapes::box({5, 0, 0}, {8, 9, 9})), closing)
              .voids()
              .empty());
}
