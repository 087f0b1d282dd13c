// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/coincident_faces.h"

#include <algorithm>
#include <numeric>

#include <catch2/catch.hpp>

#include "slicer/mesh/mesh_chain.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

const SolidMesh cube = shapes::box({0, 0, 0}, {2, 2, 2});

SolidMesh copies_of(const SolidMesh& mesh, int count) {
    SolidMesh all = mesh;
    for (int n = 1; n < count; ++n) all = shapes::joined(all, mesh);
    return all;
}

bool same(const SolidMesh& a, const SolidMesh& b) {
    return a.positions_mm == b.positions_mm && a.triangles == b.triangles && a.source_triangle == b.source_triangle;
}

/// Winding numbers at places inside and outside of the cube [0, 2]^3.
int inside(const SolidMesh& mesh) { return shapes::winding_number(mesh, {0.7, 1.1, 0.9}); }
int outside(const SolidMesh& mesh) { return shapes::winding_number(mesh, {2.7, 1.1, 0.9}); }

}  // namespace

TEST_CASE("A body that is there several times becomes one, and the first of each face stays") {
    for (const int count : {2, 3, 5}) {
        CAPTURE(count);
        SolidMesh mesh = copies_of(cube, count);
        REQUIRE(inside(mesh) == count);
        const CoincidentFaces dropped = drop_coincident_faces(mesh);
        CHECK(dropped.copies == 12 * std::size_t(count - 1));
        CHECK(dropped.back_sides == 0);
        CHECK(mesh.triangles.size() == 12);
        CHECK(inside(mesh) == 1);
        CHECK(outside(mesh) == 0);
        std::vector<std::int32_t> first(12);
        std::iota(first.begin(), first.end(), 0);
        CHECK(mesh.source_triangle == first);
    }
    // Corners in another order of the same way round are the same face.
    SolidMesh mesh = copies_of(cube, 2);
    for (std::size_t t = 12; t < 24; ++t)
        std::rotate(mesh.triangles[t].begin(), mesh.triangles[t].begin() + std::ptrdiff_t(t % 3),
                    mesh.triangles[t].end());
    CHECK(drop_coincident_faces(mesh).copies == 12);
    CHECK(inside(mesh) == 1);
}

TEST_CASE("A body more often one way round than the other stays once, that way round") {
    for (const bool outward : {true, false}) {
        CAPTURE(outward);
        const SolidMesh way = outward ? cube : shapes::flipped(cube);
        SolidMesh mesh = shapes::joined(shapes::flipped(way), copies_of(way, 2));
        REQUIRE(inside(mesh) == (outward ? 1 : -1));
        const CoincidentFaces dropped = drop_coincident_faces(mesh);
        CHECK(dropped.copies == 24);
        CHECK(mesh.triangles.size() == 12);
        CHECK(inside(mesh) == (outward ? 1 : -1));
    }
}

TEST_CASE("A body drawn from both sides becomes solid") {
    SolidMesh mesh = shapes::joined(cube, shapes::flipped(cube));
    REQUIRE(inside(mesh) == 0);
    const CoincidentFaces dropped = drop_coincident_faces(mesh);
    CHECK(dropped.back_sides == 12);
    CHECK(dropped.copies == 0);
    CHECK(mesh.triangles.size() == 12);
    CHECK(open_edges(mesh.triangles) == 0);
    CHECK(std::abs(inside(mesh)) == 1);
    CHECK(outside(mesh) == 0);
}

TEST_CASE("What shares only a part of its faces is left as it is") {
    SECTION("two bodies side by side, drawn with the face between them from both sides") {
        SolidMesh mesh = shapes::joined(cube, shapes::moved(cube, Vector3d(2, 0, 0)));
        const SolidMesh before = mesh;
        CHECK(drop_coincident_faces(mesh).copies == 0);
        CHECK(same(mesh, before));
    }
    SECTION("a body of which one face is there twice") {
        SolidMesh mesh = cube;
        mesh.triangles.push_back(mesh.triangles[4]);
        mesh.source_triangle.push_back(12);
        const SolidMesh before = mesh;
        const CoincidentFaces dropped = drop_coincident_faces(mesh);
        CHECK(dropped.copies + dropped.back_sides == 0);
        CHECK(same(mesh, before));
    }
    SECTION("a sheet with a back side") {
        SolidMesh sheet;
        sheet.positions_mm = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
        sheet = shapes::with_sources(sheet);
        const SolidMesh before = sheet;
        const CoincidentFaces dropped = drop_coincident_faces(sheet);
        CHECK(dropped.copies + dropped.back_sides == 0);
        CHECK(same(sheet, before));
    }
    SECTION("bodies in one place but for the last bit") {
        SolidMesh near = cube;
        for (Vector3d& p : near.positions_mm) p.x() = p.x() + (p.x() > 0 ? 1e-15 : 0);
        SolidMesh mesh = shapes::joined(cube, near);
        const SolidMesh before = mesh;
        CHECK(drop_coincident_faces(mesh).copies == 0);
        CHECK(same(mesh, before));
    }
}

TEST_CASE("A twice-drawn body beside another is made simple, the other is left") {
    const SolidMesh other = shapes::moved(shapes::sphere(0.7, 6), Vector3d(5, 0, 0));
    SolidMesh mesh = shapes::joined(shapes::joined(cube, other), cube);
    const std::size_t faces = other.triangles.size();
    CHECK(drop_coincident_faces(mesh).copies == 12);
    REQUIRE(mesh.triangles.size() == 12 + faces);
    CHECK(inside(mesh) == 1);
    CHECK(shapes::winding_number(mesh, {5.1, 0.1, 0.05}) == 1);
    for (std::size_t t = 0; t < faces; ++t) CHECK(mesh.source_triangle[12 + t] == std::int32_t(12 + t));
}

TEST_CASE("Two-sided bodies that share a face, or lack one, are bodies") {
    const auto two_sided = [](const SolidMesh& mesh) { return shapes::joined(shapes::flipped(mesh), mesh); };
    SECTION("the face between them is between them") {
        SolidMesh mesh = two_sided(shapes::joined(cube, shapes::moved(cube, Vector3d(2, 0, 0))));
        REQUIRE(inside(mesh) == 0);
        CHECK(drop_coincident_faces(mesh).back_sides == 28);
        CHECK(mesh.triangles.size() == 20);
        CHECK(open_edges(mesh.triangles) == 0);
        CHECK(inside(mesh) == 1);
        CHECK(shapes::winding_number(mesh, {3.3, 1.1, 0.9}) == 1);
        CHECK(shapes::winding_number(mesh, {4.3, 1.1, 0.9}) == 0);
    }
    SECTION("without a floor") {
        SolidMesh open = cube;
        open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);
        SolidMesh mesh = two_sided(shapes::with_sources(open));
        CHECK(drop_coincident_faces(mesh).back_sides == 10);
        CHECK(mesh.triangles.size() == 10);
    }
}

TEST_CASE("A two-sided sheet is told, and loses a side where that is asked for") {
    SolidMesh sheet;
    sheet.positions_mm = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.3}, {0, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
    sheet = shapes::with_sources(sheet);
    SolidMesh left = sheet;
    CHECK(drop_coincident_faces(left).sheet_mm2 > 1);
    CHECK(left.triangles.size() == 4);
    CHECK(drop_coincident_faces(sheet, true).back_sides == 2);
    CHECK(sheet.triangles.size() == 2);
}
