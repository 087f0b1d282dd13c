// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/joined_body.h"

#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

const Vector3d pitch(0.1, 0.2, 0.05);
constexpr std::size_t faces = 12;

JobBody box(const Vector3d& size, const std::vector<Vector3f>& rgb = {}) {
    return test::body_of(shapes::box(Vector3d::Zero(), size), pitch, rgb);
}

JobBody joined(const JobBody& a, const JobBody& b, const std::array<int, 3>& at) {
    Progress progress;
    const std::array bodies{BodyAt{&a, {0, 0, 0}}, BodyAt{&b, at}};
    return join_bodies(bodies, progress);
}

}  // namespace

TEST_CASE("Joined bodies lie where they were put, and every list of their meshes is as long as before") {
    const JobBody plain = box({2, 2, 1});
    JobBody coloured = box({1, 2, 1}, std::vector<Vector3f>(faces, Vector3f(1, 0.5f, 0)));
    coloured.model.mesh.materials[0].name = "glaze";
    coloured.model.mesh.corner_uv.assign(faces, {Eigen::Vector2f(1, 2), Eigen::Vector2f(3, 4), Eigen::Vector2f(5, 6)});
    coloured.model.mesh.corner_alpha.assign(faces, {0.25f, 0.5f, 1});
    coloured.model.has_colour = coloured.model.wants_colour = true;
    coloured.model.lost_colour = "a picture is gone";
    for (const bool coloured_first : {false, true}) {
        CAPTURE(coloured_first);
        const JobBody &a = coloured_first ? coloured : plain, &b = coloured_first ? plain : coloured;
        const JobBody whole = joined(a, b, {60, 5, 40});  // 6, 1 and 2 mm
        const io::TexturedMesh& mesh = whole.model.mesh;
        REQUIRE(mesh.triangles.size() == 2 * faces);
        REQUIRE(mesh.positions.size() == 16);
        CHECK(mesh.positions[0] == a.model.mesh.positions[0]);
        const Vector3d shift = b.grid.origin_mm;
        CHECK((mesh.positions[8] - (Vector3d(6, 1, 2) - shift)).norm() < 1e-9);
        CHECK(mesh.triangles[faces] == std::array<std::uint32_t, 3>{8, 10, 9});
        REQUIRE(mesh.materials.size() == 2);
        const std::size_t own = coloured_first ? 0 : faces, bare = faces - own;
        CHECK(mesh.materials[mesh.material_of_triangle[own]].name == "glaze");
        CHECK(mesh.materials[mesh.material_of_triangle[bare + 3]].name.empty());
        REQUIRE((mesh.corner_rgb.size() == 2 * faces && mesh.corner_uv.size() == 2 * faces));
        REQUIRE(mesh.corner_alpha.size() == 2 * faces);
        for (std::size_t t = 0; t < faces; ++t) {
            CHECK(mesh.corner_rgb[own + t][1] == Vector3f(1, 0.5f, 0));
            CHECK(mesh.corner_rgb[bare + t][1] == Vector3f(1, 1, 1));
            CHECK(mesh.corner_uv[own + t][2] == Eigen::Vector2f(5, 6));
            CHECK(mesh.corner_uv[bare + t][2] == Eigen::Vector2f(0, 0));
            CHECK((mesh.corner_alpha[own + t][0] == 0.25f && mesh.corner_alpha[bare + t][0] == 1));
        }
        CHECK((whole.model.has_colour && whole.model.wants_colour));
        CHECK(whole.model.lost_colour == "a picture is gone");
        CHECK(whole.grid.pitch_mm == pitch);
        for (std::size_t axis = 0; axis < 3; ++axis)
            CHECK(whole.grid.size[axis] == std::array{60, 5, 40}[axis] + b.grid.size[axis]);
        CHECK((whole.placement.extent_mm - (Vector3d(6, 1, 2) + b.placement.extent_mm)).norm() < 1e-6);
        CHECK_THAT(whole.placement.summary, Catch::Contains("2 bodies as one of "));
        // All of it is coloured surface and solid: nothing touches.
        CHECK(whole.surface->triangles.size() == 2 * faces);
        CHECK(whole.solid->triangles.size() == 2 * faces);
        CHECK(whole.solid->source_triangle[faces + 2] == std::int32_t(faces + 2));
        CHECK((whole.repair.after.shells == 2 && whole.repair.before.triangles == 2 * faces));
    }
    const JobBody white = joined(plain, plain, {60, 5, 40});
    CHECK_FALSE((white.model.has_colour || white.model.wants_colour));
    CHECK((white.model.mesh.corner_rgb.empty() && white.model.mesh.corner_alpha.empty()));
    // What lies before another's corner does not make the whole smaller.
    const JobBody inside = joined(box({4, 4, 4}), plain, {5, 5, 5});
    CHECK(inside.grid.size == box({4, 4, 4}).grid.size);
}

TEST_CASE("Marks of joined bodies stay on them, and what was repaired is added up") {
    JobBody a = box({2, 2, 1}), b = box({2, 2, 1});
    for (JobBody* body : {&a, &b}) {
        body->relief = Relief({{1, 2, 3, 4, true}}, {{1, 2, 3, 5, -1, 0.5f}});
        body->model.mesh.decals.resize(1);
        body->model.mesh.decals[0].corner_mm = {0.5, 1, 1};
        body->resin_of_decal = {body == &a ? "K" : ""};
    }
    a.repair.filled_holes = 2, b.repair.filled_holes = 3;
    a.repair.welded_vertices = 1, b.repair.welded_vertices = 10;
    a.repair.dropped_faces = 4, b.repair.dropped_faces = 5;
    a.repair.turned_faces = 6, b.repair.turned_faces = 7;
    a.repair.turned_shells = 1, b.repair.turned_shells = 2;
    a.repair.cavities = 3, b.repair.cavities = 1;
    a.repair.filled_area_mm2 = 0.5, b.repair.filled_area_mm2 = 0.25;
    a.repair.wrapped_faces = 0, b.repair.wrapped_faces = faces;
    a.repair.wrap_alpha_mm = 2, b.repair.wrap_alpha_mm = 1;
    a.repair.wrap_offset_mm = 0.1, b.repair.wrap_offset_mm = 0.3;
    a.repair.voids.resize(1), b.repair.voids.resize(2);
    b.wrapped_triangles = {0, 5};
    SolidMesh wrap = *b.solid;
    wrap.source_triangle.assign(faces, -1);
    b.solid = SolidIndex(std::move(wrap));
    const JobBody whole = joined(a, b, {60, 20, 40});
    CHECK(whole.resin_of_decal == std::vector<std::string>{"K", ""});
    REQUIRE(whole.model.mesh.decals.size() == 2);
    CHECK((whole.model.mesh.decals[1].corner_mm - whole.model.mesh.decals[0].corner_mm - Vector3d(6, 4, 2)).norm() <
          1e-9);
    REQUIRE(whole.relief.runs().size() == 2);
    const ReliefRun run = whole.relief.runs()[1];
    CHECK((run.k == 41 && run.j == 22 && run.begin == 63 && run.end == 64 && run.adds));
    REQUIRE(whole.relief.depths().size() == 2);
    const DepthRun depth = whole.relief.depths()[1];
    CHECK((depth.k == 41 && depth.j == 22 && depth.begin == 63 && depth.end == 65));
    CHECK((depth.sign == -1 && depth.offset_mm == 0.5f));
    const RepairReport& sum = whole.repair;
    CHECK((sum.filled_holes == 5 && sum.welded_vertices == 11 && sum.dropped_faces == 9 && sum.turned_faces == 13));
    CHECK((sum.turned_shells == 3 && sum.cavities == 4 && sum.filled_area_mm2 == 0.75 && sum.wrapped_faces == faces));
    CHECK((sum.wrap_alpha_mm == 2 && sum.wrap_offset_mm == 0.3 && sum.voids.size() == 3));
    CHECK(whole.wrapped_triangles == std::vector<std::uint32_t>{faces, faces + 5});
    CHECK(std::ranges::count(whole.solid->source_triangle, -1) == std::ptrdiff_t(faces));
}

TEST_CASE("Walls of joined bodies that touch are no surface") {
    const JobBody a = box({2, 2, 1}), b = box({2, 2, 1});
    // Side by side along x: the wall between them is gone from both.
    const JobBody whole = joined(a, b, {20, 0, 0});
    double area = 0;
    for (const auto& t : whole.surface->triangles) {
        const auto& p = whole.surface->positions_mm;
        area += 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
    }
    CHECK(area == Approx(2 * (4 * 2 + 4 * 1 + 2 * 1)).epsilon(1e-3));
}
