// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_diagnosis.h"

#include <catch2/catch.hpp>

#include "slicer/mesh/hole_filling.h"
#include "slicer/mesh/mesh_chain.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

MeshDiagnosis of(const SolidMesh& mesh) {
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    return diagnose(mesh.positions_mm, mesh.triangles, &tree);
}

const SolidMesh box = shapes::box({1, 2, 3}, {3, 5, 7});  // 2 x 3 x 4 mm

}  // namespace

TEST_CASE("A box has nothing unusual, its area and its volume") {
    const MeshDiagnosis d = of(box);
    CHECK(d.triangles == 12);
    CHECK(d.boundary_edges + d.nonmanifold_edges + d.inconsistent_edges + d.open_edges == 0);
    CHECK(d.degenerate_faces + d.duplicate_faces == 0);
    CHECK(d.shells == 1);
    CHECK(d.crossing_pairs == 0);
    CHECK(d.area_mm2 == Approx(2 * (6 + 8 + 12)));
    CHECK(d.volume_mm3 == Approx(24));
    CHECK(of(shapes::flipped(box)).volume_mm3 == Approx(-24));
    CHECK(diagnose(box.positions_mm, box.triangles).crossing_pairs == -1);  // nobody counted
}

TEST_CASE("What is unusual about a mesh is told apart") {
    SolidMesh open = box;
    open.triangles.pop_back();
    CHECK(of(open).boundary_edges == 3);
    CHECK(of(open).open_edges == 3);
    CHECK(of(open).nonmanifold_edges == 0);

    SolidMesh turned = box;
    std::swap(turned.triangles[4][0], turned.triangles[4][1]);
    CHECK(of(turned).inconsistent_edges == 3);
    CHECK(of(turned).open_edges == 3);
    CHECK(of(turned).boundary_edges == 0);

    SolidMesh doubled = box;
    doubled.triangles.push_back({box.triangles[2][1], box.triangles[2][2], box.triangles[2][0]});
    CHECK(of(doubled).duplicate_faces == 1);
    CHECK(of(doubled).nonmanifold_edges == 3);
    CHECK(of(doubled).open_edges == 3);
    CHECK(of(doubled).triangles == 13);

    SolidMesh flat = box;
    flat.triangles.push_back({0, 0, 1});
    flat.triangles.push_back({0, 0, 1});
    CHECK(of(flat).degenerate_faces == 2);
    CHECK(of(flat).duplicate_faces == 0);  // what has a corner twice is no face to be doubled
    CHECK(of(flat).shells == 1);
    CHECK(of(flat).boundary_edges == 0);

    const SolidMesh two = shapes::joined(box, shapes::moved(box, Vector3d(10, 0, 0)));
    CHECK(of(two).shells == 2);
    CHECK(of(two).crossing_pairs == 0);
    CHECK(of(two).volume_mm3 == Approx(48));
    CHECK(of(shapes::joined(box, shapes::moved(box, Vector3d(1, 1.3, 0.7)))).crossing_pairs > 0);
}

TEST_CASE("Two boxes that share an edge are two shells, a sheet upon a box belongs to nobody") {
    // The second box touches the first along the edge x = 2, y = 2 and has its vertices.
    SolidMesh first = shapes::box({0, 0, 0}, {2, 2, 2}), both = first;
    const SolidMesh second = shapes::box({2, 2, 0}, {4, 4, 2});
    std::vector<std::uint32_t> renamed;
    for (const Vector3d& p : second.positions_mm) {
        const auto known = std::find(both.positions_mm.begin(), both.positions_mm.end(), p);
        renamed.push_back(static_cast<std::uint32_t>(known - both.positions_mm.begin()));
        if (known == both.positions_mm.end()) both.positions_mm.push_back(p);
    }
    for (const Triangle& t : second.triangles) both.triangles.push_back({renamed[t[0]], renamed[t[1]], renamed[t[2]]});
    CHECK(of(both).nonmanifold_edges == 1);
    CHECK(of(both).open_edges == 0);
    const Shells shells = find_shells(both.triangles);
    CHECK(shells.count == 2);
    for (std::size_t t = 0; t < 24; ++t) CHECK(shells.of_triangle[t] == t / 12);
}

TEST_CASE("A hole of few corners is filled with the least area") {
    // An L of 4 mm^2: one diagonal cut more or less, and across the corner, changes the area.
    const std::vector<Vector3d> positions{{0, 0, 0}, {3, 0, 0}, {3, 1, 0},    {1, 1, 0},
                                          {1, 2, 0}, {0, 2, 0}, {0.5, 0.5, 5}};
    std::vector<Triangle> roof;  // to a point above, so that the L is open
    for (std::uint32_t n = 0; n < 6; ++n) roof.push_back({n, (n + 1) % 6, 6});
    const std::vector<HoleFill> fills = fill_holes(positions, roof);
    REQUIRE(fills.size() == 1);
    CHECK(fills[0].loop.size() == 6);
    CHECK(fills[0].triangles.size() == 4);
    double filled = 0;
    for (const Triangle& t : fills[0].triangles) filled += area(positions, t);
    CHECK(filled == Approx(4));
    std::vector<Triangle> all = roof;
    all.insert(all.end(), fills[0].triangles.begin(), fills[0].triangles.end());
    CHECK(open_edges(all) == 0);
    // Outward from below.
    for (const Triangle& t : fills[0].triangles)
        CHECK((positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]).z() < 0);
}

TEST_CASE("A hole of many corners is filled ear by ear, without leaving its plane or its outline") {
    // A star of 300 corners, every second one further in: ears at reflex corners would lie outside.
    constexpr std::uint32_t n = 300;
    std::vector<Vector3d> positions;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n, r = i % 2 ? 8 : 10;
        positions.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
    positions.emplace_back(0, 0, 20);
    std::vector<Triangle> roof;
    for (std::uint32_t i = 0; i < n; ++i) roof.push_back({i, (i + 1) % n, n});
    const std::vector<HoleFill> fills = fill_holes(positions, roof);
    REQUIRE(fills.size() == 1);
    CHECK(fills[0].triangles.size() == n - 2);
    double filled = 0, outline = 0;
    for (const Triangle& t : fills[0].triangles) filled += area(positions, t);
    for (std::uint32_t i = 0; i < n; ++i) outline += positions[i].cross(positions[(i + 1) % n]).z() / 2;
    CHECK(filled == Approx(outline));
    std::vector<Triangle> all = roof;
    all.insert(all.end(), fills[0].triangles.begin(), fills[0].triangles.end());
    CHECK(open_edges(all) == 0);
    // The teeth are cut first: their new edges are the shortest.
    for (std::size_t t = 0; t < n / 4; ++t) {
        const auto& [a, b, c] = fills[0].triangles[t];
        CHECK(b % 2 == 0);
        CHECK((positions[c] - positions[a]).norm() < 0.5);
    }
}
