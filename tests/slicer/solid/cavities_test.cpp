// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/cavities.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "slicer/mesh/mesh_chain.h"
#include "slicer/solid/solid.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

RepairedMesh repaired(const SolidMesh& mesh) {
    voxtone::io::TexturedMesh textured;
    textured.positions = mesh.positions_mm;
    textured.triangles = mesh.triangles;
    return repair_mesh(textured, {});
}

SolidMesh shell(double radius, double wall, int n = 40) {
    return shapes::joined(shapes::sphere(radius, n), shapes::flipped(shapes::sphere(radius - wall, n)));
}

/// Triangles near some places are cut out of both shells, and the rims are joined: a wall with pinholes.
SolidMesh with_pinholes(double radius, double wall, int n, std::size_t every) {
    const SolidMesh outer = shapes::sphere(radius, n), inner = shapes::sphere(radius - wall, n);
    const auto shift = std::uint32_t(outer.positions_mm.size());
    SolidMesh mesh;
    mesh.positions_mm = outer.positions_mm;
    mesh.positions_mm.insert(mesh.positions_mm.end(), inner.positions_mm.begin(), inner.positions_mm.end());
    for (std::size_t t = 0; t < outer.triangles.size(); ++t) {
        const auto& [a, b, c] = outer.triangles[t];
        if (t % every != every / 2) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a + shift, c + shift, b + shift});
            continue;
        }
        for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}}) {  // the hole's own walls
            mesh.triangles.push_back({p, q, q + shift});
            mesh.triangles.push_back({p, q + shift, p + shift});
        }
    }
    return shapes::with_sources(mesh);
}

std::uint64_t voxels(const SolidMesh& mesh, double radius) {
    VoxelGrid grid;
    grid.pitch_mm = Vector3d(0.0847, 0.0423, 0.1);
    grid.origin_mm = Vector3d::Constant(-radius - 0.5);
    for (int a = 0; a < 3; ++a) grid.size[std::size_t(a)] = int((2 * radius + 1) / grid.pitch_mm[a]);
    const SpanSlab slab = Solid(mesh, grid).slab(0, grid.size[2]);
    std::uint64_t sum = 0;
    for (int k = 0; k < grid.size[2]; ++k) sum += slab.voxels_of_layer(k);
    return sum;
}

CavityOptions mode(CavityMode mode) {
    CavityOptions options;
    options.mode = mode;
    return options;
}

}  // namespace

TEST_CASE("A second shell a fraction of a millimetre inside is no wall: the body is what the outer one encloses",
          "[cavities]") {
    for (const double wall : {0.012, 0.12, 0.23, 0.9}) {
        CAPTURE(wall);
        RepairedMesh mesh = repaired(shell(10, wall));
        const std::vector<Cavity> found = treat_cavities(mesh, {});
        REQUIRE(found.size() == 1);
        CHECK(found[0].filled);
        CHECK(found[0].wall_mm == Approx(wall).margin(0.02));
        CHECK(found[0].volume_mm3 == Approx(shapes::volume(shapes::sphere(10 - wall, 40))).epsilon(1e-6));
        CHECK(Vector3d(found[0].centre_mm[0], found[0].centre_mm[1], found[0].centre_mm[2])
                  .isApprox(Vector3d(10, 10, 10), 0.02));
        CHECK(mesh.solid->triangles == shapes::sphere(10, 40).triangles);
        CHECK(mesh.report.after.shells == 1);
    }
}

TEST_CASE("A wall as thick as the coloured shell is meant, unless all is to be filled", "[cavities]") {
    const SolidMesh thick = shell(10, 1.1);
    RepairedMesh kept = repaired(thick);
    const std::vector<Cavity> found = treat_cavities(kept, {});
    REQUIRE(found.size() == 1);
    CHECK_FALSE(found[0].filled);
    CHECK(kept.solid->triangles == thick.triangles);

    CavityOptions deeper;
    deeper.shell_mm = 1.3;
    RepairedMesh deep = repaired(thick);
    CHECK(treat_cavities(deep, deeper)[0].filled);
    RepairedMesh all = repaired(thick);
    CHECK(treat_cavities(all, mode(CavityMode::fill))[0].filled);
    CHECK(all.solid->triangles == shapes::sphere(10, 40).triangles);
    RepairedMesh none = repaired(shell(10, 0.12));
    CHECK_FALSE(treat_cavities(none, mode(CavityMode::keep))[0].filled);
    CHECK(none.solid->triangles.size() == shell(10, 0.12).triangles.size());
}

TEST_CASE("Shells that pinholes bridge are filled, and the outer surface keeps its shape", "[cavities]") {
    const double radius = 6, wall = 0.12;
    const SolidMesh bridged = with_pinholes(radius, wall, 120, 997);  // edges of 0.16 mm at most
    REQUIRE(open_edges(bridged.triangles) == 0);
    RepairedMesh mesh = repaired(bridged);
    REQUIRE(mesh.report.after.shells == 1);
    const std::vector<Cavity> found = treat_cavities(mesh, {});
    REQUIRE(found.size() == 1);
    CHECK(found[0].filled);
    CHECK(found[0].wall_mm == Approx(wall).margin(0.02));
    CHECK(open_edges(mesh.solid->triangles) == 0);
    const auto ball = double(voxels(shapes::sphere(radius, 120), radius));
    CHECK(double(voxels(*mesh.solid, radius)) == Approx(ball).epsilon(1e-4));
    // Rims are closed across, so no more than the holes' triangles and a few are new.
    const auto made = std::ranges::count(mesh.solid->source_triangle, -1);
    CHECK(made > 20);
    CHECK(made < 400);
}

TEST_CASE("In whatever order its triangles come, the same void is filled", "[cavities]") {
    const SolidMesh bridged = with_pinholes(3, 0.12, 60, 397);
    RepairedMesh as_it_is = repaired(bridged);
    REQUIRE(treat_cavities(as_it_is, {}).size() == 1);
    // A wall of a pinhole, which sees nothing by itself, comes first.
    const auto outer = std::uint32_t(bridged.positions_mm.size() / 2);
    const auto wall = std::ranges::find_if(bridged.triangles, [&](const auto& t) {
        return std::ranges::any_of(t, [&](std::uint32_t c) { return c < outer; }) &&
               std::ranges::any_of(t, [&](std::uint32_t c) { return c >= outer; });
    });
    REQUIRE(wall != bridged.triangles.end());
    for (const std::ptrdiff_t more : {0, 1}) {
        CAPTURE(more);
        SolidMesh turned = bridged;
        std::ranges::rotate(turned.triangles, turned.triangles.begin() + (wall - bridged.triangles.begin()) + more);
        RepairedMesh mesh = repaired(turned);
        const std::vector<Cavity> found = treat_cavities(mesh, {});
        REQUIRE(found.size() == 1);
        CHECK(found[0].filled);
        CHECK(open_edges(mesh.solid->triangles) == 0);
        CHECK(mesh.solid->triangles.size() == as_it_is.solid->triangles.size());
        CHECK(shapes::volume(*mesh.solid) == Approx(shapes::volume(*as_it_is.solid)).epsilon(1e-9));
    }
}

TEST_CASE("What lies within a filled void goes with it, bodies inside a body stay a union", "[cavities]") {
    RepairedMesh mesh = repaired(shapes::joined(shell(10, 0.12), shapes::box({-2, -2, -2}, {2, 2, 2})));
    REQUIRE(treat_cavities(mesh, {}).size() == 1);
    CHECK(mesh.solid->triangles == shapes::sphere(10, 40).triangles);

    const SolidMesh nested = shapes::joined(shapes::sphere(10, 40), shapes::sphere(9.88, 40));
    RepairedMesh as_it_is = repaired(nested);
    CHECK(treat_cavities(as_it_is, {}).empty());
    CHECK(as_it_is.solid->triangles == nested.triangles);
}

TEST_CASE("A room of slabs that cross one another is filled, or said to be hollow still where its walls are too thin",
          "[cavities]") {
    for (const double wall : {0.5, 0.08}) {
        CAPTURE(wall);
        const double far = 12 - wall;
        SolidMesh room = shapes::box({0, 0, 0}, {12, 12, wall});
        for (const auto& [low, high] : {std::pair{Vector3d(0, 0, far), Vector3d(12, 12, 12)},
                                        {Vector3d(0, 0, 0), Vector3d(wall, 12, 12)},
                                        {Vector3d(far, 0, 0), Vector3d(12, 12, 12)},
                                        {Vector3d(0, 0, 0), Vector3d(12, wall, 12)},
                                        {Vector3d(0, far, 0), Vector3d(12, 12, 12)}})
            room = shapes::joined(room, shapes::box(low, high));
        RepairedMesh mesh = repaired(room);
        const std::vector<Cavity> found = treat_cavities(mesh, {});
        REQUIRE(found.size() == 1);
        CHECK(found[0].filled == (wall == 0.5));
        CHECK(found[0].crossed == (wall != 0.5));
        CHECK(open_edges(mesh.solid->triangles) == 0);
        const std::vector<std::string> said = cavity_sentences(found, {}, 1728);
        REQUIRE(said.size() == 1);
        CHECK((said[0].find("boolean union") != std::string::npos) == (wall != 0.5));
        if (wall != 0.5) continue;
        // Solid throughout, and no larger.
        const SolidMesh moved = shapes::moved(*mesh.solid, Vector3d(-6, -6, -6)),
                        cube = shapes::box({-6, -6, -6}, {6, 6, 6});
        CHECK(voxels(moved, 6) == voxels(cube, 6));
    }
}

TEST_CASE("Sentences name volume, place, share and wall", "[cavities]") {
    Cavity thin;
    thin.volume_mm3 = 250, thin.wall_mm = 0.12, thin.centre_mm = {1, 2, 3}, thin.filled = true;
    Cavity thick;
    thick.volume_mm3 = 100, thick.wall_mm = 5;
    const std::vector<std::string> said = cavity_sentences({thin, thin, thick}, {}, 900);  // and 100 of void
    REQUIRE(said.size() == 2);
    CHECK(said[0] ==
          "2 voids of 500 mm^3, 50 % of what the outer surface encloses, the largest at 1.0, 2.0, 3.0 mm from the "
          "model's corner, behind walls from 0.12 mm, thinner than the coloured shell of 1 mm, were filled with resin; "
          "--cavities keep leaves that to support material.");
    CHECK(said[1].starts_with("A void of 100 mm^3, 10 % of what the outer surface encloses, at 0.0, 0.0, 0.0 mm"));
    CHECK(said[1].find("--cavities fill") != std::string::npos);
    thick.volume_mm3 = 17'600;  // larger than its walls
    CHECK(cavity_sentences({thick}, {}, 9'400)[0].starts_with("A void of 17.6 ml, 65 % of"));
    CHECK(cavity_sentences({thick}, {}, 4)[0].starts_with("A void of 17.6 ml, 100 % of"));
    thick.crossed = true;
    CHECK(cavity_sentences({thick}, {}, 9'400)[0].starts_with("A void of 17.6 ml, 65 % of"));
    CHECK(cavity_sentences({}, {}, 1).empty());
}
