// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_repair.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "shapes.h"
#include "slicer/mesh/hole_filling.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_orientation.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

io::TexturedMesh textured(const SolidMesh& m) {
    io::TexturedMesh t;
    t.positions = m.positions_mm;
    t.triangles = m.triangles;
    t.material_of_triangle.assign(m.triangles.size(), 0);
    t.materials.resize(1);
    return t;
}

// Every triangle with corners of its own.
io::TexturedMesh soup(const SolidMesh& m, double shake) {
    RandomStream random(3, 3);
    io::TexturedMesh t = textured(m);
    t.positions.clear();
    for (auto& f : t.triangles)
        for (auto& v : f) {
            t.positions.push_back(m.positions_mm[v] + shake * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5,
                                                                       random.uniform() - 0.5));
            v = std::uint32_t(t.positions.size() - 1);
        }
    return t;
}

RepairedMesh repair(const io::TexturedMesh& m, RepairMode mode = RepairMode::automatic, double pitch_mm = 0.027) {
    RepairOptions options;
    options.mode = mode;
    options.pitch_mm = pitch_mm;
    return repair_mesh(m, options);
}

double volume(const RepairedMesh& r) { return shapes::volume(*r.solid); }

const SolidMesh cube = shapes::box({0, 0, 0}, {2, 2, 2});

}  // namespace

TEST_CASE("Closed meshes stay as they are, crossings and cavities included") {
    const SolidMesh cavity = shapes::joined(cube, shapes::flipped(shapes::box({0.5, 0.5, 0.5}, {1, 1, 1})));
    const SolidMesh overlap = shapes::joined(cube, shapes::moved(cube, Vector3d(1, 0.5, 0.25)));
    // Two boxes that share an edge: four faces meet there.
    SolidMesh sharing = shapes::joined(cube, shapes::box({2, 2, 0}, {3, 3, 2}));
    for (auto& t : sharing.triangles)
        for (auto& v : t)
            if (v == 8 || v == 12) v = v == 8 ? 3 : 7;
    for (const SolidMesh& m : {cube, cavity, overlap, sharing}) {
        for (RepairMode mode : {RepairMode::off, RepairMode::automatic}) {
            const RepairedMesh r = repair(textured(m), mode);
            CHECK(r.solid->triangles == m.triangles);
            CHECK(r.solid->source_triangle == m.source_triangle);
            CHECK(r.report.messages.empty());
            CHECK(r.report.before == r.report.after);
        }
    }
    CHECK(repair(textured(cavity)).report.cavities == 1);
    CHECK(repair(textured(overlap)).report.before.crossing_pairs > 0);
    CHECK(repair(textured(cube)).report.before.crossing_pairs == 0);
    CHECK(repair(textured(sharing)).report.before.nonmanifold_edges == 1);
    CHECK(repair(textured(sharing)).report.before.shells == 2);
}

TEST_CASE("Shells that face inward are turned, with what is inside them") {
    CHECK(volume(repair(textured(shapes::flipped(cube)))) == Approx(8));
    CHECK(repair(textured(shapes::flipped(cube))).report.turned_shells == 1);
    // One of two.
    const SolidMesh two = shapes::joined(shapes::flipped(cube), shapes::moved(cube, Vector3d(5, 0, 0)));
    CHECK(volume(repair(textured(two))) == Approx(16));
    CHECK(repair(textured(two)).report.turned_shells == 1);
    // Inside out as a whole, with a cavity that must stay one.
    const SolidMesh inner = shapes::box({0.5, 0.5, 0.5}, {1, 1, 1});
    const RepairedMesh r = repair(textured(shapes::joined(shapes::flipped(cube), inner)));
    CHECK(volume(r) == Approx(8 - 0.125));
    CHECK(r.report.cavities == 1);
    // An inverted part that stands half in another is no cavity.
    const SolidMesh half_in = shapes::joined(cube, shapes::flipped(shapes::box({1.5, 0.5, 0.5}, {3.5, 1, 1})));
    CHECK(repair(textured(half_in)).report.turned_shells == 1);
}

TEST_CASE("Faces that disagree, doubled faces and faces without area are mended") {
    const SolidMesh sphere = shapes::sphere(1, 10);
    io::TexturedMesh m = textured(sphere);
    for (std::size_t t = 0; t < m.triangles.size(); t += 3) std::swap(m.triangles[t][0], m.triangles[t][1]);
    RepairedMesh r = repair(m);
    CHECK(r.report.before.inconsistent_edges > 100);
    CHECK(r.report.after.open_edges == 0);
    CHECK(r.report.turned_faces == (m.triangles.size() + 2) / 3);
    CHECK(volume(r) == Approx(shapes::volume(sphere)));
    CHECK(r.report.filled_holes == 0);

    m = textured(sphere);
    m.triangles.push_back(m.triangles[5]);
    m.triangles.push_back({m.triangles[7][1], m.triangles[7][0], m.triangles[7][2]});
    m.triangles.push_back({4, 4, 9});
    r = repair(m);
    CHECK(r.report.before.duplicate_faces == 2);
    CHECK(r.report.before.degenerate_faces == 1);
    CHECK(r.report.dropped_faces == 3);
    CHECK(volume(r) == Approx(shapes::volume(sphere)));
}

TEST_CASE("A body that is there several times in one place is taken once") {
    const SolidMesh sphere = shapes::sphere(1, 10);
    SolidMesh indexed = sphere;  // three times on the same corners
    for (int n = 0; n < 2; ++n)
        indexed.triangles.insert(indexed.triangles.end(), sphere.triangles.begin(), sphere.triangles.end());
    for (const SolidMesh& m : {shapes::joined(shapes::joined(sphere, sphere), sphere), indexed}) {
        const RepairedMesh r = repair(textured(m));
        CHECK(r.solid->triangles == sphere.triangles);
        CHECK(r.solid->source_triangle == sphere.source_triangle);
        CHECK(r.report.dropped_faces == 2 * sphere.triangles.size());
        REQUIRE(r.report.messages.size() == 1);
        CHECK_THAT(r.report.messages[0], Catch::Contains("taken once"));
        CHECK(repair(textured(m), RepairMode::off).solid->triangles.size() == 3 * sphere.triangles.size());
    }
    // A cavity that is there once stays hollow.
    const SolidMesh hollow = shapes::joined(cube, shapes::flipped(shapes::box({0.5, 0.5, 0.5}, {1, 1, 1})));
    CHECK(volume(repair(textured(shapes::joined(hollow, cube)))) == Approx(8 - 0.125));
    // A face too many of either side, on a body that is closed without them.
    SolidMesh more = sphere;
    more.triangles.push_back(sphere.triangles[7]);
    more.triangles.push_back({sphere.triangles[7][1], sphere.triangles[7][0], sphere.triangles[7][2]});
    CHECK(volume(repair(textured(more))) == Approx(shapes::volume(sphere)));
}

TEST_CASE("A two-sided body is solid, a two-sided sheet stays a sheet") {
    const SolidMesh sphere = shapes::sphere(1, 10);
    SolidMesh indexed = sphere, alternating = sphere;
    const SolidMesh back = shapes::flipped(sphere);
    indexed.triangles.insert(indexed.triangles.end(), back.triangles.begin(), back.triangles.end());
    alternating.triangles.clear();
    for (std::size_t t = 0; t < sphere.triangles.size(); ++t) {  // now the front first, now the back
        alternating.triangles.push_back(t % 3 ? sphere.triangles[t] : back.triangles[t]);
        alternating.triangles.push_back(t % 3 ? back.triangles[t] : sphere.triangles[t]);
    }
    for (const SolidMesh& m : {shapes::joined(sphere, back), indexed, alternating}) {
        const RepairedMesh r = repair(textured(m));
        CHECK(volume(r) == Approx(shapes::volume(sphere)));
        CHECK(r.solid->triangles.size() == sphere.triangles.size());
        CHECK(r.report.dropped_faces == sphere.triangles.size());
        REQUIRE(!r.report.messages.empty());
        CHECK_THAT(r.report.messages[0], Catch::Contains("two-sided"));
    }
    SolidMesh sheet = cube;
    sheet.triangles = {cube.triangles[0], cube.triangles[1], shapes::flipped(cube).triangles[0],
                       shapes::flipped(cube).triangles[1]};
    CHECK(repair(textured(sheet)).solid->triangles == sheet.triangles);
    // Two boxes that share a whole face, each with its own.
    SolidMesh beside = shapes::joined(cube, shapes::moved(cube, Vector3d(2, 0, 0)));
    CHECK(repair(textured(beside)).solid->triangles == beside.triangles);
    CHECK(volume(repair(textured(beside))) == Approx(16));
}

TEST_CASE("Holes are filled on the vertices that are there, and fills have no source") {
    // Box without its top: 20 mm^3 with the hole filled flat.
    SolidMesh open = shapes::box({0, 0, 0}, {2, 2, 5});
    open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);
    const RepairedMesh r = repair(textured(open));
    CHECK(r.report.before.boundary_edges == 4);
    CHECK(r.report.filled_holes == 1);
    CHECK(r.report.filled_area_mm2 == Approx(4));
    CHECK(volume(r) == Approx(20));
    CHECK(std::count(r.solid->source_triangle.begin(), r.solid->source_triangle.end(), -1) == 2);
    CHECK(r.solid->positions_mm.size() == open.positions_mm.size());
    CHECK(r.report.after.open_edges == 0);
    CHECK_THROWS_AS(repair(textured(open), RepairMode::off), InputError);
    CHECK_THROWS_WITH(repair(textured(open), RepairMode::off), Catch::Contains("4 boundary edges"));

    // A long boundary goes ear by ear: a tube of 600 sides, open at both ends.
    SolidMesh tube;
    const std::uint32_t n = 600;
    for (std::uint32_t s = 0; s < 2 * n; ++s) {
        const double a = 2 * std::numbers::pi * (s % n) / n;
        tube.positions_mm.emplace_back(std::cos(a), std::sin(a), s < n ? 0 : 4);
    }
    for (std::uint32_t s = 0; s < n; ++s) {
        const std::uint32_t q = (s + 1) % n;
        tube.triangles.push_back({s, q, q + n});
        tube.triangles.push_back({s, q + n, s + n});
    }
    const RepairedMesh filled = repair(textured(tube));
    CHECK(filled.report.filled_holes == 2);
    CHECK(volume(filled) == Approx(4 * 0.5 * n * std::sin(2 * std::numbers::pi / n)).epsilon(1e-9));
}

TEST_CASE("What an inverted part lies beside is no body around it") {
    // An L of two boxes of one shell: the small one stands in its notch, within its box and outside of it.
    SolidMesh l;
    for (const double z : {0.0, 2.0})
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {6.0, 0.0}, {6.0, 2.0}, {2.0, 2.0}, {2.0, 6.0}, {0.0, 6.0}})
            l.positions_mm.emplace_back(x, y, z);
    for (const auto& [a, b, c] : {Triangle{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
        l.triangles.push_back({a, c, b});
        l.triangles.push_back({a + 6, b + 6, c + 6});
    }
    for (std::uint32_t a = 0; a < 6; ++a) {
        const std::uint32_t b = (a + 1) % 6;
        l.triangles.push_back({a, b, b + 6});
        l.triangles.push_back({a, b + 6, a + 6});
    }
    REQUIRE(shapes::volume(l) == Approx(40));
    const RepairedMesh r = repair(textured(shapes::joined(l, shapes::flipped(shapes::box({4, 4, 0.5}, {5, 5, 1.5})))));
    CHECK(r.report.turned_shells == 1);
    CHECK(r.report.cavities == 0);
    CHECK(volume(r) == Approx(41));
}

TEST_CASE("Cracks between faces are welded") {
    const SolidMesh sphere = shapes::sphere(10, 12);
    const RepairedMesh r = repair(soup(sphere, 1e-4));
    CHECK(r.report.before.boundary_edges == 3 * sphere.triangles.size());
    CHECK(r.report.after.open_edges == 0);
    CHECK(r.report.filled_holes == 0);
    CHECK(r.report.wrapped_faces == 0);
    CHECK(volume(r) == Approx(shapes::volume(sphere)).epsilon(1e-4));
}

TEST_CASE("Any set of faces becomes a closed chain") {
    for (std::uint64_t round = 0; round < 50; ++round) {
        RandomStream random(11, round);
        io::TexturedMesh m;
        const std::uint32_t vertices = 6 + random.bits() % 10;
        for (std::uint32_t v = 0; v < vertices; ++v)
            m.positions.emplace_back(random.uniform() * 9, random.uniform() * 9, random.uniform() * 9);
        for (int t = 0; t < 11; ++t)
            m.triangles.push_back({random.bits() % vertices, random.bits() % vertices, random.bits() % vertices});
        const auto fills = fill_holes(m.positions, m.triangles);
        std::vector<Triangle> all = m.triangles;
        for (const HoleFill& f : fills) all.insert(all.end(), f.triangles.begin(), f.triangles.end());
        CHECK(open_edges(all) == 0);
        CHECK(open_edges(repair(m, RepairMode::fill).solid->triangles) == 0);
        try {
            const RepairedMesh automatic = repair(m);
            CHECK(open_edges(automatic.solid->triangles) == 0);
        } catch (const InputError& error) {
            CHECK_THAT(error.what(), Catch::Contains("--repair fill"));
        }
        RepairOptions thick;
        thick.sheet_mm = 0.5;
        CHECK(open_edges(repair_mesh(m, thick).solid->triangles) == 0);
    }
}

TEST_CASE("A body in shreds is wrapped", "[wrap][slow]") {
    const SolidMesh sphere = shapes::sphere(3, 8);
    const RepairedMesh r = repair(soup(sphere, 0.2), RepairMode::automatic, 0.1);
    CHECK(r.report.wrapped_faces == sphere.triangles.size());
    CHECK(r.wrapped_triangles.size() == sphere.triangles.size());
    CHECK(r.report.after.open_edges == 0);
    CHECK(r.report.messages.size() >= 1);
    // As large as the sphere, give or take the shaking and the offset.
    CHECK(volume(r) > 0.9 * shapes::volume(sphere));
    CHECK(volume(r) < 1.25 * shapes::volume(sphere));
    CHECK(repair(textured(cube), RepairMode::wrap, 0.1).report.wrapped_faces == 12);
}

TEST_CASE("Faces that a wrap stands for are told by their numbers in the model", "[wrap]") {
    // A sheet without area among the faces of a cube is left out: what comes after it keeps its number all the same.
    io::TexturedMesh m = textured(cube);
    const auto sheet = m.triangles.begin() + 5;
    m.triangles.insert(sheet, Triangle{0, 0, 1});
    m.material_of_triangle.assign(m.triangles.size(), 0);
    RepairedMesh r = repair(m, RepairMode::wrap, 0.1);
    CHECK(r.report.wrapped_faces == 12);
    std::sort(r.wrapped_triangles.begin(), r.wrapped_triangles.end());
    CHECK(r.wrapped_triangles == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12});
    CHECK(std::all_of(r.solid->source_triangle.begin(), r.solid->source_triangle.end(), [](auto t) { return t < 0; }));
    CHECK(r.report.wrap_alpha_mm > 0);
    CHECK(r.report.wrap_offset_mm == 0.1);
}

TEST_CASE("Nothing to print is said") {
    io::TexturedMesh m;
    CHECK_THROWS_AS(repair(m), InputError);
    m.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    m.triangles = {{0, 1, 2}};
    CHECK_THROWS_AS(repair(m), InputError);
}

// Cases that take all pairs where sums are not kept: at these sizes hours, so that ctest's time limit finds them.

TEST_CASE("An edge with a hundred thousand faces is oriented in time", "[bounds]") {
    const std::uint32_t faces = 100'000;
    std::vector<Triangle> fan;
    for (std::uint32_t f = 0; f < faces; ++f) fan.push_back(f % 3 == 0 ? Triangle{0, 1, f + 2} : Triangle{1, 0, f + 2});
    const std::size_t turned = orient_consistently(fan);
    CHECK(turned > 0);
    // As many one way as the other at the common edge.
    long sum = 0;
    for (const EdgeUse& use : edge_uses(fan))
        if (use.low == 0 && use.high == 1) sum += use.sign;
    CHECK(sum == 0);
}

TEST_CASE("A large hole beside very many small ones is filled in time", "[bounds][slow]") {
    // A fan of 200,000 triangles around a point, open at its rim, and 50,000 triangles alone.
    const std::uint32_t rim = 200'000, alone = 50'000;
    std::vector<Vector3d> positions{Vector3d(0, 0, 1)};
    std::vector<Triangle> triangles;
    for (std::uint32_t n = 0; n < rim; ++n) {
        const double a = 2 * 3.14159265358979 * n / rim;
        positions.emplace_back(100 * std::cos(a), 100 * std::sin(a), 0);
        triangles.push_back({0, 1 + n, 1 + (n + 1) % rim});
    }
    for (std::uint32_t n = 0; n < alone; ++n) {
        const auto first = std::uint32_t(positions.size());
        for (const Vector3d& corner : {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)})
            positions.push_back(corner + Vector3d(0, 0, 2 + n));
        triangles.push_back({first, first + 1, first + 2});
    }
    const std::vector<HoleFill> fills = fill_holes(positions, triangles);
    CHECK(fills.size() == alone + 1);
    for (const HoleFill& fill : fills) triangles.insert(triangles.end(), fill.triangles.begin(), fill.triangles.end());
    CHECK(open_edges(triangles) == 0);
}
