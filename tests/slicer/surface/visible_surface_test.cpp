// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/surface/visible_surface.h"

#include <catch2/catch.hpp>

#include "tests/slicer/mesh/shapes.h"
#include "voxtone/base/random.h"
#include "voxtone/slicer/mesh/mesh_chain.h"
#include "voxtone/slicer/mesh/winding_number.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

struct Seen {
    io::TexturedMesh mesh;
    RepairedMesh repaired;
    VisibleSurface surface;
    VisibleSurfaceReport report;

    explicit Seen(const SolidMesh& m, RepairMode mode = RepairMode::automatic) {
        mesh.positions = m.positions_mm;
        mesh.triangles = m.triangles;
        RepairOptions options;
        options.mode = mode;
        repaired = repair_mesh(mesh, options);
        surface = find_visible_surface(mesh.positions, mesh.triangles, repaired, 0.05, &report);
    }
    [[nodiscard]] double area() const {
        double sum = 0;
        for (const auto& t : surface.triangles) sum += slicer::area(surface.positions_mm, t);
        return sum;
    }
    // Corners lie where their (u, v) says; patches lie on a corner.
    void check_places(bool patches = false) const {
        REQUIRE(surface.source_triangle.size() == surface.triangles.size());
        REQUIRE(surface.source_uv.size() == surface.triangles.size());
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            const auto& source = mesh.triangles[surface.source_triangle[t]];
            const Vector3d &a = mesh.positions[source[0]], &b = mesh.positions[source[1]],
                           &c = mesh.positions[source[2]];
            for (int n = 0; n < 3; ++n) {
                const Vector3d place =
                    a + double(surface.source_uv[t][n][0]) * (b - a) + double(surface.source_uv[t][n][1]) * (c - a);
                const double off = (place - surface.positions_mm[surface.triangles[t][n]]).norm();
                if (patches && surface.source_uv[t][0] == surface.source_uv[t][1])
                    REQUIRE((place - surface.positions_mm[surface.triangles[t][0]]).norm() < 1e-12);
                else
                    REQUIRE(off < 1e-5);
            }
        }
    }
};

const SolidMesh cube = shapes::box({0, 0, 0}, {2, 2, 2});

}  // namespace

TEST_CASE("A single body is visible as it is") {
    const SolidMesh sphere = shapes::sphere(1, 10);
    const Seen seen(sphere);
    CHECK(seen.surface.triangles == sphere.triangles);
    CHECK(seen.surface.positions_mm == sphere.positions_mm);
    seen.check_places();
    // Turned faces keep their places.
    Seen(shapes::flipped(sphere)).check_places();
}

TEST_CASE("What lies inside the body is hidden, a cavity is not") {
    const Seen nested(shapes::joined(cube, shapes::box({0.5, 0.5, 0.5}, {1, 1, 1})));
    CHECK(nested.surface.triangles == cube.triangles);
    CHECK(nested.report.hidden == 12);
    CHECK(nested.report.cut == 0);
    CHECK(Seen(shapes::joined(cube, shapes::flipped(shapes::box({0.5, 0.5, 0.5}, {1, 1, 1})))).area() ==
          Approx(24 + 1.5));
    CHECK(Seen(shapes::joined(cube, shapes::moved(cube, Vector3d(5, 0, 0)))).area() == Approx(48));
    // Side by side: the faces between are hidden.
    CHECK(Seen(shapes::joined(cube, shapes::moved(cube, Vector3d(2, 0, 0)))).area() == Approx(40));
}

TEST_CASE("Overlapping shells show the surface of their union") {
    const SolidMesh other = shapes::moved(cube, Vector3d(1.1, 0.7, 0.3));
    const Seen seen(shapes::joined(cube, other));
    seen.check_places();
    CHECK(seen.report.cut > 0);
    // Union of two boxes: both surfaces less the surface of what they share, 0.9 x 1.3 x 1.7.
    const double expected = 48 - 2 * (0.9 * 1.3 + 1.3 * 1.7 + 1.7 * 0.9);
    // Along the crossing curve (each edge of the shared box lies on one face of either) pieces of up to 0.05 mm may be
    // wrong.
    CHECK(std::abs(seen.area() - expected) < 0.05 * 2 * 4 * (0.9 + 1.3 + 1.7));
    // No piece lies inside the other box by more than a piece.
    for (const auto& t : seen.surface.triangles) {
        const Vector3d c =
            (seen.surface.positions_mm[t[0]] + seen.surface.positions_mm[t[1]] + seen.surface.positions_mm[t[2]]) / 3;
        const bool in_first = (c.array() > 0.06).all() && (c.array() < 1.94).all();
        const Vector3d d = c - Vector3d(1.1, 0.7, 0.3);
        const bool in_second = (d.array() > 0.06).all() && (d.array() < 1.94).all();
        REQUIRE(!in_first);
        REQUIRE(!in_second);
    }
    // The same turned in space.
    CHECK(std::abs(Seen(shapes::moved(shapes::joined(cube, other), shapes::tilt())).area() - expected) < 1.6);
}

TEST_CASE("Patches count for depth and have the colours of their corners") {
    SolidMesh open = shapes::box({0, 0, 0}, {2, 2, 5});
    open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);
    const Seen seen(shapes::with_sources(open));
    CHECK(seen.area() == Approx(2 * 4 + 4 * 10));
    CHECK(seen.report.patches == 2);
    CHECK(seen.surface.triangles.size() == 10 + 2 * 6);
    seen.check_places(true);
}

TEST_CASE("A wrap leaves the colour to the faces it stands for", "[wrap]") {
    const SolidMesh both = shapes::joined(cube, shapes::box({0.5, 0.5, 0.5}, {1, 1, 1}));
    const Seen seen(both, RepairMode::wrap);
    CHECK(seen.area() == Approx(24).epsilon(0.01));
    CHECK(seen.report.hidden >= 12);
    seen.check_places();
}

TEST_CASE("Winding numbers by rays agree with solid angles") {
    const SolidMesh mesh =
        shapes::joined(shapes::joined(cube, shapes::moved(shapes::torus(1.3, 0.6, 20, 12), shapes::tilt())),
                       shapes::flipped(shapes::sphere(0.9, 8)));
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    RandomStream random(2, 2);
    for (int n = 0; n < 2000; ++n) {
        Vector3d p = 5 * Vector3d(random.uniform(), random.uniform(), random.uniform()) - Vector3d(2, 2, 2);
        if (n % 4 == 0) p = (p * 4).array().round() / 4 + 1e-3;  // rays along edges and diagonals of the box
        REQUIRE(winding_number(tree, p) == shapes::winding_number(mesh, p));
    }
}
