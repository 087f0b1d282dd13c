// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/thin_walls.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "slicer/mesh/mesh_repair.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

/// All of a closed mesh, each triangle its own source.
VisibleSurface surface_of(const SolidMesh& solid) {
    VisibleSurface surface;
    surface.positions_mm = solid.positions_mm;
    surface.triangles = solid.triangles;
    const Eigen::Vector2f zero(0, 0), one_u(1, 0), one_v(0, 1);
    for (std::uint32_t t = 0; t < solid.triangles.size(); ++t) {
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({zero, one_u, one_v});
    }
    return surface;
}

std::vector<ThinWall> walls_of(const SolidMesh& solid, double limit_mm = 0.6) {
    Progress progress;
    return find_thin_walls(surface_of(solid), SolidIndex(solid), limit_mm, progress);
}

}  // namespace

TEST_CASE("A wall is thin below the limit, and as thick and as long as it is") {
    for (const double thickness : {0.2, 0.5}) {
        const std::vector<ThinWall> walls = walls_of(shapes::box(Vector3d::Zero(), {8, 5, thickness}));
        CAPTURE(thickness);
        REQUIRE(walls.size() == 1);
        CHECK(walls[0].thickness_mm == Approx(thickness).margin(1e-3));  // looked for from just below the face
        CHECK(walls[0].length_mm == Approx(std::hypot(8, 5)).margin(0.5));
        CHECK((walls[0].middle_mm - Vector3d(4, 2.5, thickness / 2)).norm() < 0.3);
    }
    CHECK(walls_of(shapes::box(Vector3d::Zero(), {8, 5, 0.61})).empty());
    CHECK(walls_of(shapes::box(Vector3d::Zero(), {8, 5, 0.5}), 0.4).empty());
}

TEST_CASE("What is said to be large enough has no thin walls, and of what tapers nothing is said") {
    Progress progress;
    const auto larger = [&](const SolidMesh& solid) {
        return larger_without_thin_walls(surface_of(solid), SolidIndex(solid), 0.6, progress);
    };
    CHECK(larger(shapes::box(Vector3d::Zero(), {8, 5, 0.5})) == 1.25);
    CHECK(larger(shapes::box(Vector3d::Zero(), {8, 5, 0.25})) == 3.0);
    CHECK(walls_of(shapes::box(Vector3d::Zero(), 3 * Vector3d(8, 5, 0.25))).empty());
    CHECK_FALSE(larger(shapes::box(Vector3d::Zero(), {8, 5, 0.1})));
    // A wedge: 3 mm of its edge are thinner than 0.6 mm at any size.
    SolidMesh wedge;
    wedge.positions_mm = {{0, 0, 0}, {0, 5, 0}, {5, 0, -0.5}, {5, 5, -0.5}, {5, 0, 0.5}, {5, 5, 0.5}};
    wedge.triangles = {{0, 4, 5}, {0, 5, 1}, {0, 3, 2}, {0, 1, 3}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
    REQUIRE(walls_of(wedge).size() == 1);
    CHECK_FALSE(larger(wedge));
}

TEST_CASE("A thick body with thin legs is thin at these alone, each a place of its own") {
    SolidMesh body = shapes::box({0, 0, 5}, {10, 10, 12});
    for (const double x : {1.0, 8.0}) body = shapes::joined(body, shapes::box({x, 4, 0}, {x + 0.3, 4.4, 6}));
    const std::vector<ThinWall> walls = walls_of(body);
    REQUIRE(walls.size() == 2);
    for (const ThinWall& wall : walls) {
        CHECK(wall.thickness_mm > 0.29);
        CHECK(wall.thickness_mm < 0.41);
        CHECK(wall.middle_mm.z() < 4);
        CHECK(wall.source_triangle >= 12);
    }
    CHECK(std::abs(walls[0].middle_mm.x() - walls[1].middle_mm.x()) == Approx(7).margin(0.3));
}

TEST_CASE("Edges and corners of thick bodies, tips of cones and shells within each other are no thin walls") {
    CHECK(walls_of(shapes::box(Vector3d::Zero(), {10, 10, 10})).empty());
    CHECK(walls_of(shapes::sphere(4, 24)).empty());
    // One box in another: the line goes on through the inner one's skin.
    CHECK(walls_of(shapes::joined(shapes::box(Vector3d::Zero(), {10, 10, 10}), shapes::box({0.3, 0.3, 0.3}, {9, 9, 9})))
              .empty());
    // A plate hidden in the body, just below its face: the line leaves the plate, and not the body.
    Progress progress;
    const SolidMesh outer = shapes::box(Vector3d::Zero(), {10, 10, 10});
    const SolidIndex with_plate(shapes::joined(outer, shapes::box({1, 1, 9.7}, {9, 9, 9.9})));
    CHECK(find_thin_walls(surface_of(outer), with_plate, 0.6, progress).empty());
    // A pyramid whose upper half a millimetre is thinner than the limit.
    SolidMesh pyramid;
    pyramid.positions_mm = {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {3, 3, 6}};
    pyramid.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    CHECK(walls_of(pyramid).empty());
}

TEST_CASE("Pieces on or in a thick body are no walls by themselves, low ribs neither, fins are") {
    const SolidMesh body = shapes::box(Vector3d::Zero(), {8, 4, 2});
    const Eigen::AlignedBox3d inside(Vector3d::Zero(), Vector3d(8, 4, 2));
    // `low` and `high`: of a box beside it; `out_low` and `out_high`: what of that is outside of the body.
    const auto with = [&](const Vector3d& low, const Vector3d& high, const Vector3d& out_low,
                          const Vector3d& out_high) {
        SolidMesh seen = shapes::box(out_low, out_high);
        std::erase_if(seen.triangles, [&](const auto& triangle) {
            return std::ranges::all_of(triangle,
                                       [&](auto corner) { return inside.contains(seen.positions_mm[corner]); });
        });
        Progress progress;
        return find_thin_walls(surface_of(shapes::joined(body, seen)),
                               SolidIndex(shapes::joined(body, shapes::box(low, high))), 0.6, progress);
    };
    CHECK(with({0, 1.8, 1.9}, {8, 2.2, 2.1}, {0, 1.8, 2}, {8, 2.2, 2.1}).empty());        // a stripe, let in
    CHECK(with({0, 1.8, 2}, {8, 2.2, 2.1}, {0, 1.8, 2}, {8, 2.2, 2.1}).empty());          // laid on: a face is shared
    CHECK(with({0, 1.8, 2.02}, {8, 2.2, 2.3}, {0, 1.8, 2.02}, {8, 2.2, 2.3}).empty());    // less than a layer above
    CHECK(with({-0.1, 0.5, 0.5}, {0.3, 3.5, 1}, {-0.1, 0.5, 0.5}, {0, 3.5, 1}).empty());  // a bumper
    const std::vector<ThinWall> fin = with({0, 1.8, 1.9}, {8, 2.2, 4}, {0, 1.8, 2}, {8, 2.2, 4});
    REQUIRE(fin.size() == 1);
    CHECK(fin[0].thickness_mm == Approx(0.4).margin(1e-3));
    CHECK(with({0, 1.8, 2.4}, {8, 2.2, 4}, {0, 1.8, 2.4}, {8, 2.2, 4}).size() == 1);  // with air below
}

TEST_CASE("A body that is smaller than what is told of others is told when most of it is thin") {
    CHECK(walls_of(shapes::box(Vector3d::Zero(), {0.3, 0.3, 1})).size() == 1);
    CHECK(walls_of(shapes::box(Vector3d::Zero(), {0.8, 0.8, 0.8})).empty());
}

TEST_CASE("Pieces that meet in a point or an edge alone are told, and those that overlap or share a face are not") {
    const auto box_at = [](const Vector3d& low) { return shapes::box(low, low + Vector3d(4, 4, 4)); };
    const auto both = [&](const Vector3d& second) {
        SolidMesh solid = box_at(Vector3d::Zero());
        const SolidMesh more = box_at(second);
        // Corners in one place are one.
        for (const auto& triangle : more.triangles) {
            auto& made = solid.triangles.emplace_back();
            for (std::size_t c = 0; c < 3; ++c) {
                const Vector3d& at = more.positions_mm[triangle[c]];
                const auto same = std::ranges::find(solid.positions_mm, at);
                made[c] = std::uint32_t(same - solid.positions_mm.begin());
                if (same == solid.positions_mm.end()) solid.positions_mm.push_back(at);
            }
        }
        return bare_joints(solid, 0.6);
    };
    const auto point = both({4, 4, 4});
    REQUIRE(point.size() == 1);
    CHECK(point[0] == Vector3d(4, 4, 4));
    CHECK(both({4, 4, 0}).size() == 1);  // an edge
    CHECK(both({4, 0, 0}).empty());      // a face
    CHECK(both({3, 3, 3}).empty());      // overlap
    CHECK(both({5, 5, 5}).empty());      // apart
}
