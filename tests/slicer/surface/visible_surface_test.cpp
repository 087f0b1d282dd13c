// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/visible_surface.h"

#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_crossings.h"
#include "slicer/mesh/mesh_orientation.h"
#include "slicer/mesh/winding_number.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

struct Seen {
    io::TexturedMesh mesh;
    RepairedMesh repaired;
    VisibleSurface surface;
    VisibleSurfaceReport report;

    explicit Seen(const SolidMesh& m, RepairMode mode = RepairMode::automatic, double label_mm = 0) {
        mesh.positions = m.positions_mm;
        mesh.triangles = m.triangles;
        RepairOptions options;
        options.mode = mode;
        repaired = repair_mesh(mesh, options);
        surface = find_visible_surface(mesh.positions, mesh.triangles, repaired,
                                       {.piece_mm = 0.05, .label_mm = label_mm}, &report);
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

/// The same faces in whichever order, each from its lowest corner on.
std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

}  // namespace

TEST_CASE("A single body is visible as it is") {
    const SolidMesh sphere = shapes::sphere(1, 10);
    const Seen seen(sphere);
    CHECK(sorted(seen.surface.triangles) == sorted(sphere.triangles));
    CHECK(seen.surface.positions_mm == sphere.positions_mm);
    seen.check_places();
    // Turned faces keep their places.
    Seen(shapes::flipped(sphere)).check_places();
}

TEST_CASE("The surface is the same in whichever order its file has it") {
    const SolidMesh mesh = shapes::joined(shapes::sphere(1, 9), shapes::moved(cube, Vector3d(0.5, 0.2, 0.1)));
    const auto places = [](const Seen& seen) {
        std::vector<std::array<Vector3d, 3>> all;
        for (const auto& [a, b, c] : seen.surface.triangles) {
            const auto& p = seen.surface.positions_mm;
            all.push_back({p[a], p[b], p[c]});
        }
        return all;
    };
    const auto wanted = places(Seen(mesh));
    SolidMesh shuffled = mesh;
    const std::size_t n = mesh.positions_mm.size(), faces = mesh.triangles.size();
    for (std::size_t v = 0; v < n; ++v) shuffled.positions_mm[n - 1 - v] = mesh.positions_mm[v];
    for (std::size_t t = 0; t < faces; ++t) {
        Triangle corners = mesh.triangles[(7 * t + 3) % faces];
        for (std::uint32_t& v : corners) v = static_cast<std::uint32_t>(n) - 1 - v;
        std::rotate(corners.begin(), corners.begin() + std::ptrdiff_t(t % 3), corners.end());
        shuffled.triangles[t] = corners;
    }
    REQUIRE(faces % 7 != 0);
    CHECK(places(Seen(shuffled)) == wanted);
}

TEST_CASE("What lies inside the body is hidden, a cavity is not") {
    const Seen nested(shapes::joined(cube, shapes::box({0.5, 0.5, 0.5}, {1, 1, 1})));
    CHECK(sorted(nested.surface.triangles) == sorted(cube.triangles));
    CHECK(nested.report.hidden == 12);
    CHECK(nested.report.cut == 0);
    // Whichever the file has first.
    const Seen inner_first(shapes::joined(shapes::box({0.5, 0.5, 0.5}, {1, 1, 1}), cube));
    CHECK(inner_first.area() == Approx(24));
    CHECK(inner_first.report.hidden == 12);
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

TEST_CASE("A label on a face comes before the body, wherever the file has it, and a little above it") {
    SolidMesh label;
    label.positions_mm = {{0.5, 0.5, 2}, {1.5, 0.5, 2}, {1.5, 1.5, 2}, {0.5, 1.5, 2}};
    label.triangles = {{0, 1, 2}, {0, 2, 3}};
    label = shapes::with_sources(label);
    for (const bool first : {false, true}) {
        CAPTURE(first);
        const Seen seen(first ? shapes::joined(label, cube) : shapes::joined(cube, label));
        const std::uint32_t begin = first ? 0 : 12;
        for (std::size_t t = 0; t < 2; ++t) {
            CHECK(seen.surface.source_triangle[t] >= begin);
            CHECK(seen.surface.source_triangle[t] < begin + 2);
        }
        CHECK(seen.area() == Approx(24 + 2));  // the label's front and back
        seen.check_places(true);
    }
    // One a little above is laid onto it.
    for (const double above : {0.01, 0.2}) {
        CAPTURE(above);
        const Seen seen(shapes::joined(cube, shapes::moved(label, {0, 0, above})), RepairMode::automatic, 0.1);
        for (std::size_t t = 0; t < 2; ++t)
            for (const std::uint32_t corner : seen.surface.triangles[t])
                CHECK(seen.surface.positions_mm[corner].z() == Approx(above < 0.1 ? 2 : 2 + above));
    }
    // A body with a hole in a side is no label.
    SolidMesh open = cube;
    open.triangles.pop_back();
    open.source_triangle.pop_back();
    const Seen body(shapes::joined(shapes::box({-4, 0, 0}, {-3, 1, 1}), open));
    CHECK(body.surface.source_triangle.front() < 12);
}

TEST_CASE("A wrap leaves the colour to the faces it stands for", "[wrap][slow]") {
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

namespace {

// Boxes around one point, each a little larger than the last: `count` shells that all lie in one another.
SolidMesh nested_boxes(int count) {
    SolidMesh all = cube;
    for (int n = 1; n < count; ++n)
        all = shapes::joined(all, shapes::box(-0.01 * n * Vector3d::Ones(), (2 + 0.01 * n) * Vector3d::Ones()));
    return all;
}

// Boxes that cross each other, all of them.
SolidMesh crossing_boxes(int count) {
    SolidMesh all = cube;
    for (int n = 1; n < count; ++n)
        all = shapes::joined(all, shapes::moved(cube, Vector3d(0.013 * n, 0.017 * n, 0.011 * n)));
    return all;
}

// Steps that the search for crossings takes.
std::uint64_t crossing_work(const SolidMesh& mesh) {
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    WorkBudget work(std::uint64_t{1} << 60);
    (void)find_crossings(tree, work);
    return work.spent();
}

struct Listener : Progress {
    std::vector<std::string> warnings;
    std::uint64_t steps = 0;

protected:
    void on_warning(const std::string& message) override { warnings.push_back(message); }
    void on_advance(std::uint64_t done) override { steps = std::max(steps, done); }
};

RepairedMesh repaired_of(const SolidMesh& mesh, io::TexturedMesh& textured) {
    textured.positions = mesh.positions_mm;
    textured.triangles = mesh.triangles;
    RepairOptions options;
    options.count_crossings_up_to = 0;
    return repair_mesh(textured, options);
}

}  // namespace

TEST_CASE("The search for crossings grows with the mesh, and with all pairs only in a heap", "[bounds]") {
    // Four times as many triangles of a smooth body: about four times the work.
    const double smooth = double(crossing_work(shapes::sphere(10, 40))) / double(crossing_work(shapes::sphere(10, 20)));
    CHECK(smooth < 6);
    // Twice as many triangles in one place: four times; that is what the budget is for.
    const SolidMesh heap = crossing_boxes(40), twice = crossing_boxes(80);
    CHECK(double(crossing_work(twice)) / double(crossing_work(heap)) > 3);
    const TriangleTree tree(twice.positions_mm, twice.triangles);
    WorkBudget little(10'000), enough(crossing_work(twice));
    CHECK_THROWS_AS(find_crossings(tree, little), WorkExceeded);
    CHECK_THROWS_AS(count_crossings(tree, little), WorkExceeded);
    CHECK(little.spent() < 10'000 + twice.triangles.size() * 20);  // stopped there, and not much later
    CHECK_NOTHROW(find_crossings(tree, enough));
}

TEST_CASE("Crossings are mutual and in order", "[bounds]") {
    const SolidMesh mesh = crossing_boxes(6);
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    WorkBudget work(1'000'000);
    const auto crossings = find_crossings(tree, work);
    std::size_t pairs = 0;
    for (std::uint32_t t = 0; t < crossings.size(); ++t) {
        CHECK(std::is_sorted(crossings[t].begin(), crossings[t].end()));
        for (const std::uint32_t other : crossings[t]) {
            CHECK(std::binary_search(crossings[other].begin(), crossings[other].end(), t));
            ++pairs;
        }
    }
    CHECK(pairs > 0);
    CHECK(pairs == 2 * count_crossings(tree, work));  // no two of these boxes share a corner
}

TEST_CASE("A heap of triangles is cut coarsely, and at last refused, in a sentence", "[bounds]") {
    io::TexturedMesh textured;
    const SolidMesh heap = crossing_boxes(10);
    const RepairedMesh repaired = repaired_of(heap, textured);
    Listener listener;
    const auto find = [&](std::uint64_t most_steps) {
        listener.warnings.clear();
        return find_visible_surface(textured.positions, textured.triangles, repaired,
                                    {.piece_mm = 0.05, .most_steps = most_steps}, nullptr, &listener);
    };
    const VisibleSurface fine = find(0);
    CHECK(listener.warnings.empty());
    CHECK(listener.steps <= 2 * repaired.solid->triangles.size());
    CHECK(listener.steps > repaired.solid->triangles.size());
    // From too little work up to enough: coarse with a warning, then as fine as asked for.
    VisibleSurface coarse, enough;
    for (std::uint64_t steps = 4 * crossing_work(heap);; steps *= 2) {
        VisibleSurface found = find(steps);
        if (listener.warnings.empty()) {
            enough = std::move(found);
            break;
        }
        REQUIRE(listener.warnings.size() == 1);
        CHECK_THAT(listener.warnings[0], Catch::Contains("mm rough") && Catch::Contains("[rough-edges]"));
        coarse = std::move(found);
    }
    CHECK(enough.triangles.size() == fine.triangles.size());
    CHECK(!coarse.triangles.empty());
    CHECK(coarse.triangles.size() < fine.triangles.size());
    // Six faces of the first and the last box lie free, 24 mm2. Of the other boxes strips stand out on all six sides,
    // as wide as the next box is farther: less than a piece, so they may be missed, or seen as twice what they are.
    const double dx = 0.013, dy = 0.017, dz = 0.011,
                 strips = 9 * 2 * (12 - (2 - dx) * (2 - dy) - (2 - dy) * (2 - dz) - (2 - dz) * (2 - dx));
    for (const double area : {coloured_area_mm2(fine), coloured_area_mm2(coarse)}) {
        CHECK(area > 24 - 1e-9);
        CHECK(area < 24 + 2 * strips);
    }
    CHECK(std::abs(coloured_area_mm2(fine) - (24 + strips)) < strips / 2);
    CHECK_THROWS_AS(find(1000), InputError);
    CHECK_THROWS_WITH(find(1000), Catch::Contains("lie on or across one another") && Catch::Contains("unite"));
}

namespace {

/// A waisted tower of `sectors` straight slivers each way, that run around more than a third of it: each of their boxes
/// meets hundreds of others.
SolidMesh twisted_tower(std::uint32_t sectors) {
    SolidMesh mesh;
    const double turn = 2.4;
    for (const double z : {0.0, 10.0})
        for (std::uint32_t n = 0; n < sectors; ++n) {
            const double angle = 2 * 3.14159265358979 * n / sectors + (z > 0 ? turn : 0);
            mesh.positions_mm.emplace_back(5 * std::cos(angle), 5 * std::sin(angle), z);
        }
    mesh.positions_mm.emplace_back(0, 0, 0);
    mesh.positions_mm.emplace_back(0, 0, 10);
    for (std::uint32_t n = 0; n < sectors; ++n) {
        const std::uint32_t next = (n + 1) % sectors;
        mesh.triangles.push_back({n, next, sectors + n});
        mesh.triangles.push_back({next, sectors + next, sectors + n});
        mesh.triangles.push_back({next, n, 2 * sectors});
        mesh.triangles.push_back({sectors + n, sectors + next, 2 * sectors + 1});
    }
    return shapes::with_sources(mesh);
}

}  // namespace

TEST_CASE("Thousands of long thin triangles take bounded work, and are left whole where none cross", "[bounds][slow]") {
    const SolidMesh tower = twisted_tower(600);
    // Far more than of a smooth body of as many triangles, far less than is allowed.
    CHECK(crossing_work(tower) > 1000 * tower.triangles.size());
    CHECK(crossing_work(tower) < WorkBudget::for_triangles(tower.triangles.size()) / 4);
    io::TexturedMesh textured;
    const RepairedMesh repaired = repaired_of(tower, textured);
    Listener listener;
    const VisibleSurface surface =
        find_visible_surface(textured.positions, textured.triangles, repaired, {.piece_mm = 0.05}, nullptr, &listener);
    CHECK(listener.warnings.empty());
    CHECK(surface.triangles.size() == tower.triangles.size());
    CHECK_THROWS_WITH(find_visible_surface(textured.positions, textured.triangles, repaired,
                                           {.piece_mm = 0.05, .most_steps = 100'000}, nullptr, &listener),
                      Catch::Contains("long and thin") && Catch::Contains("remesh"));
    listener.cancel();
    CHECK_THROWS_AS(find_visible_surface(textured.positions, textured.triangles, repaired, {}, nullptr, &listener),
                    Cancelled);
}

TEST_CASE("A repair moves its bar from the beginning to the end, whatever there is to mend", "[bounds][slow]") {
    struct Steps : Listener {
        std::size_t times = 0;

    private:
        void on_advance(std::uint64_t done) override {
            Listener::on_advance(done);
            ++times;
        }
    };
    SolidMesh open = shapes::sphere(2, 30);
    open.triangles.resize(open.triangles.size() - 40);
    open = shapes::with_sources(open);
    for (const SolidMesh& mesh : {shapes::sphere(2, 30), open})
        for (const RepairMode mode : {RepairMode::automatic, RepairMode::wrap}) {
            io::TexturedMesh textured;
            textured.positions = mesh.positions_mm;
            textured.triangles = mesh.triangles;
            for (const std::size_t counted : {std::size_t{0}, std::size_t{1'000'000}}) {
                RepairOptions options{.mode = mode, .pitch_mm = 0.1, .count_crossings_up_to = counted};
                Steps steps;
                (void)repair_mesh(textured, options, &steps);
                CHECK(steps.steps == repair_steps(textured));
                if (counted > 0 || mode == RepairMode::wrap) CHECK(steps.times > 5);
            }
        }
}

TEST_CASE("What is bounded can be stopped", "[bounds]") {
    io::TexturedMesh textured;
    const RepairedMesh repaired = repaired_of(crossing_boxes(5), textured);
    Progress cancelled;
    cancelled.cancel();
    CHECK_THROWS_AS(find_visible_surface(textured.positions, textured.triangles, repaired, {}, nullptr, &cancelled),
                    Cancelled);
    // Already in the count of crossings of the repair.
    CHECK_THROWS_AS(repair_mesh(textured, {}, &cancelled), Cancelled);
    SolidMesh inward = shapes::flipped(nested_boxes(5));
    const Shells shells = find_shells(inward.triangles);
    CHECK_THROWS_AS(orient_outward(inward.positions_mm, inward.triangles, shells, &cancelled), Cancelled);
}

TEST_CASE("Shells in shells: turned as a whole, and refused where there are too many to tell", "[bounds]") {
    SolidMesh inward = shapes::flipped(nested_boxes(30));
    const Shells shells = find_shells(inward.triangles);
    REQUIRE(shells.count == 30);
    std::vector<Triangle> triangles = inward.triangles;
    const ShellTurns turns = orient_outward(inward.positions_mm, triangles, shells);
    CHECK(turns.turned == 30);
    CHECK(turns.cavities == 0);
    CHECK_THROWS_WITH(orient_outward(inward.positions_mm, inward.triangles, shells, nullptr, 1000),
                      Catch::Contains("cavities") && Catch::Contains("unite"));
    // Far from one another none is asked about another, so little work does.
    SolidMesh apart = cube;
    for (int n = 1; n < 200; ++n) apart = shapes::joined(apart, shapes::moved(cube, Vector3d(3.0 * n, 0, 0)));
    apart = shapes::flipped(apart);
    CHECK(orient_outward(apart.positions_mm, apart.triangles, find_shells(apart.triangles), nullptr, 1000).turned ==
          200);
}
