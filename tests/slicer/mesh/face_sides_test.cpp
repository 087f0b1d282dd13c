// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/face_sides.h"

#include <algorithm>
#include <numeric>

#include <catch2/catch.hpp>

#include "slicer/mesh/mesh_repair.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

const SolidMesh body = shapes::box({0, 0, 0}, {2, 2, 2});

/// Faces with corners of their own, each of material 1 (front) where `front` says so and else of material 0.
io::TexturedMesh coloured(const std::vector<std::array<Vector3d, 3>>& faces, const std::vector<bool>& front) {
    io::TexturedMesh mesh;
    mesh.materials.resize(2);
    mesh.materials[1].rgb = {1, 0, 0};
    for (const auto& face : faces) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), face.begin(), face.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    for (const bool is_front : front) mesh.material_of_triangle.push_back(is_front ? 1 : 0);
    return mesh;
}

std::array<Vector3d, 3> places(const SolidMesh& mesh, const Triangle& t) {
    return {mesh.positions_mm[t[0]], mesh.positions_mm[t[1]], mesh.positions_mm[t[2]]};
}

/// Share of the repaired surface that has the front's material.
double front_share(const io::TexturedMesh& mesh, const RepairedMesh& repaired) {
    std::size_t front = 0;
    for (const std::int32_t source : repaired.solid->source_triangle)
        front += source >= 0 && mesh.material_of_triangle[static_cast<std::size_t>(source)] == 1;
    return double(front) / double(repaired.solid->triangles.size());
}

bool says(const RepairedMesh& repaired, std::string_view words) {
    return std::ranges::any_of(repaired.report.messages,
                               [&](const std::string& m) { return m.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("Of two sides the one that looks outward has the colour, whatever their order") {
    enum Order { front_first, back_first, alternating, grouped, back_grouped };
    for (const Order order : {front_first, back_first, alternating, grouped, back_grouped})
        for (const bool all : {true, false}) {
            CAPTURE(int(order), all);
            std::vector<std::array<Vector3d, 3>> faces;
            std::vector<bool> front;
            const auto add = [&](std::size_t t, bool is_front) {
                if (!is_front && !all && t % 3 == 0) return;  // some faces have no back side
                Triangle corners = body.triangles[t];
                if (!is_front) std::swap(corners[1], corners[2]);
                faces.push_back(places(body, corners));
                front.push_back(is_front);
            };
            const std::size_t n = body.triangles.size();
            for (std::size_t t = 0; t < n && order <= alternating; ++t) {
                const bool first = order == front_first || (order == alternating && t % 2 == 0);
                add(t, first);
                add(t, !first);
            }
            for (std::size_t t = 0; t < 2 * n && order > alternating; ++t) add(t % n, (t < n) == (order == grouped));
            const io::TexturedMesh mesh = coloured(faces, front);
            const RepairedMesh repaired = repair_mesh(mesh, {});
            CHECK(shapes::volume(*repaired.solid) == Approx(8));
            CHECK(front_share(mesh, repaired) == 1);
            CHECK(says(repaired, "another colour"));
            if (all) CHECK_FALSE(says(repaired, "turned outward"));
        }
}

TEST_CASE("Rooms of a two-sided house have their outward sides, and the wall between them is no hole") {
    // A house of 4 x 2 x 2 with a wall at x = 2; every face twice, the back sides first.
    const SolidMesh left = shapes::box({0, 0, 0}, {2, 2, 2}), right = shapes::box({2, 0, 0}, {4, 2, 2});
    std::vector<std::array<Vector3d, 3>> faces;
    std::vector<bool> front;
    for (const SolidMesh& room : {left, right})
        for (std::size_t t = 0; t < room.triangles.size(); ++t) {
            const auto face = places(room, room.triangles[t]);
            const bool between = face[0].x() == 2 && face[1].x() == 2 && face[2].x() == 2;
            if (between && room.positions_mm[0].x() == 2) continue;  // once
            faces.push_back({face[0], face[2], face[1]});
            faces.push_back(face);
            front.insert(front.end(), {false, true});
        }
    const io::TexturedMesh mesh = coloured(faces, front);
    const RepairedMesh repaired = repair_mesh(mesh, {});
    CHECK(shapes::winding_number(*repaired.solid, {1.1, 0.9, 1.2}) != 0);
    CHECK(shapes::winding_number(*repaired.solid, {3.1, 0.9, 1.2}) != 0);
    for (std::size_t t = 0; t < repaired.solid->triangles.size(); ++t) {
        const std::int32_t source = repaired.solid->source_triangle[t];
        const auto face = places(*repaired.solid, repaired.solid->triangles[t]);
        const Vector3d middle = (face[0] + face[1] + face[2]) / 3;
        if (source < 0 || middle.x() == 2) continue;
        CHECK(mesh.material_of_triangle[static_cast<std::size_t>(source)] == 1);
    }
}

TEST_CASE("Faces of one side that lie on each other have the first one's colour, and a word where they differ") {
    for (const bool first_is_front : {true, false}) {
        std::vector<std::array<Vector3d, 3>> faces;
        std::vector<bool> front;
        for (const bool is_front : {first_is_front, !first_is_front})
            for (const Triangle& t : body.triangles) {
                faces.push_back(places(body, t));
                front.push_back(is_front);
            }
        const io::TexturedMesh mesh = coloured(faces, front);
        const RepairedMesh repaired = repair_mesh(mesh, {});
        CHECK(front_share(mesh, repaired) == (first_is_front ? 1 : 0));
        CHECK(says(repaired, "12 of the faces"));
        std::vector<bool> same(24, true);
        CHECK_FALSE(says(repair_mesh(coloured(faces, same), {}), "another colour"));
    }
}

TEST_CASE("Colours of corners and texture coordinates tell faces in one place apart") {
    std::vector<std::array<Vector3d, 3>> faces;
    for (int side = 0; side < 2; ++side)
        for (const Triangle& t : body.triangles) faces.push_back(places(body, t));
    io::TexturedMesh mesh = coloured(faces, std::vector<bool>(24, true));
    std::vector<PiledFace> piled;
    for (std::size_t t = 0; t < 24; ++t) piled.push_back({body.triangles[t % 12], std::int32_t(t)});
    CHECK(count_other_colours(mesh, piled) == 0);
    mesh.corner_rgb.assign(24, {Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones()});
    CHECK(count_other_colours(mesh, piled) == 0);
    mesh.corner_rgb[15][2] = {0, 1, 0};
    CHECK(count_other_colours(mesh, piled) == 1);
}
