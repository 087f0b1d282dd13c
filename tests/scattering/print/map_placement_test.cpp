// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/map_placement.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::slicer;
using Eigen::Vector2f;
using Eigen::Vector3d;

namespace {

io::TexturedMesh textured(const SolidMesh& solid) {
    io::TexturedMesh mesh;
    mesh.positions = solid.positions_mm;
    mesh.triangles = solid.triangles;
    mesh.material_of_triangle.assign(mesh.triangles.size(), 0);
    mesh.materials.resize(1);
    return mesh;
}

}  // namespace

TEST_CASE("By texture coordinates a map's unit square is as large as the map") {
    io::TexturedMesh mesh = textured(shapes::box({0, 0, 0}, {1, 1, 1}));
    CHECK_THROWS_AS(MapPlacement::by_texture(mesh, 10, 20), InputError);
    mesh.corner_uv.assign(mesh.triangles.size(), {Vector2f(0.3f, 0.3f), Vector2f(0.3f, 0.3f), Vector2f(0.3f, 0.3f)});
    CHECK_THROWS_AS(MapPlacement::by_texture(mesh, 10, 20), InputError);  // a point is no place
    mesh.corner_uv[5] = {Vector2f(0.1f, 0.2f), Vector2f(0.5f, 0.2f), Vector2f(0.1f, 1.2f)};
    const MapPlacement placement = MapPlacement::by_texture(mesh, 10, 20);
    CHECK((placement.at(5, 0, 0) - Vector2f(1, 4)).norm() < 1e-5f);
    CHECK((placement.at(5, 1, 0) - Vector2f(5, 4)).norm() < 1e-5f);
    CHECK((placement.at(5, 0, 1) - Vector2f(1, 24)).norm() < 1e-5f);
    CHECK((placement.at(5, 0.25f, 0.5f) - Vector2f(2, 14)).norm() < 1e-5f);
    CHECK((placement.at(0, 0.5f, 0.1f) - Vector2f(3, 6)).norm() < 1e-5f);
    // Either side of a triangle alone is a place too.
    mesh.corner_uv.assign(mesh.triangles.size(), {Vector2f(0, 0), Vector2f(0, 0), Vector2f(1, 0)});
    CHECK(MapPlacement::by_texture(mesh, 10, 20).at(0, 0, 1).x() == Approx(10));
}

TEST_CASE("By box a map stands upright and readable on each of the six sides, from their lower left corner") {
    const Vector3d low(1, 2, 3), high(5, 8, 12);  // 4 x 6 x 9 mm
    const io::TexturedMesh mesh = textured(shapes::box(low, high));
    const MapPlacement placement = MapPlacement::by_box(mesh);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vector3d &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        const Vector3d out = (q - p).cross(r - p).normalized();
        // As a person sees it who stands before the side with the head up: +z, or +y on top and below.
        const Vector3d up = std::abs(out.z()) > 0.5 ? Vector3d::UnitY() : Vector3d::UnitZ();
        const Vector3d right = up.cross(out);
        const auto wanted = [&](const Vector3d& x) {
            const auto from_low = [&](const Vector3d& along) {
                return along.dot(x) - std::min(along.dot(low), along.dot(high));
            };
            return Vector2f(float(from_low(right)), float(from_low(up)));
        };
        CAPTURE(t, out.transpose());
        CHECK((placement.at(t, 0, 0) - wanted(p)).norm() < 1e-5f);
        CHECK((placement.at(t, 1, 0) - wanted(q)).norm() < 1e-5f);
        CHECK((placement.at(t, 0, 1) - wanted(r)).norm() < 1e-5f);
        CHECK((placement.at(t, 0.2f, 0.3f) - wanted(0.5 * p + 0.2 * q + 0.3 * r)).norm() < 1e-5f);
    }
}

TEST_CASE("By box the side is the one that a triangle looks to most") {
    io::TexturedMesh mesh = textured(shapes::box({0, 0, 0}, {10, 10, 10}));
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    // Inside the box, so that it stays as large. Each spans the plane across its normal.
    std::vector<std::pair<Vector3d, int>> normals{{{3, 2, 1}, 0},  {{-3, 2, 1}, 0}, {{2, 3, 1}, 1},
                                                  {{1, -3, 2}, 1}, {{1, 2, 3}, 2},  {{2, 1, -3}, 2}};
    for (const auto& [normal, axis] : normals) {
        const Vector3d u = normal.unitOrthogonal(), v = normal.normalized().cross(u);
        for (const Vector3d& p : {Vector3d(0, 0, 0), u, v}) mesh.positions.emplace_back(Vector3d(5, 5, 5) + p);
        const auto n = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.triangles.push_back({n - 3, n - 2, n - 1});
    }
    const MapPlacement placement = MapPlacement::by_box(mesh);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const auto& [normal, axis] = normals[i];
        const auto t = static_cast<std::uint32_t>(mesh.triangles.size() - normals.size() + i);
        const Vector3d step = mesh.positions[first + 3 * i + 1] - mesh.positions[first + 3 * i];
        const Vector2f moved = placement.at(t, 1, 0) - placement.at(t, 0, 0);
        CAPTURE(i);
        CHECK(std::abs(moved.x()) == Approx(std::abs(step[axis == 0 ? 1 : 0])).margin(1e-5));
        CHECK(moved.y() == Approx(step[axis == 2 ? 1 : 2]).margin(1e-5));
    }
}
