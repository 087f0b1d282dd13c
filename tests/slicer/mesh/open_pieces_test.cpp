// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/open_pieces.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_repair.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

/// n x n squares over [0, 10]^2.
template <class Height>
SolidMesh terrain(std::uint32_t n, Height&& height) {
    SolidMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double x = 10.0 * i / n, y = 10.0 * j / n;
            mesh.positions_mm.emplace_back(x, y, height(x, y));
        }
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (n + 1) + i; };
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return shapes::with_sources(mesh);
}

double hills(double x, double y) { return std::sin(x) * std::cos(1.3 * y); }

SolidMesh without(SolidMesh mesh, std::initializer_list<std::size_t> triangles) {
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (std::ranges::find(triangles, t) == triangles.end()) kept.push_back(mesh.triangles[t]);
    mesh.triangles = kept;
    return shapes::with_sources(mesh);
}

std::vector<OpenPiece> pieces_of(const SolidMesh& mesh) {
    return open_pieces(mesh.positions_mm, mesh.triangles, fill_holes(mesh.positions_mm, mesh.triangles));
}

OpenPiece::Kind kind_of_one(const SolidMesh& mesh) {
    const std::vector<OpenPiece> pieces = pieces_of(mesh);
    REQUIRE(pieces.size() == 1);
    return pieces[0].kind;
}

RepairedMesh repaired(const SolidMesh& mesh, RepairOptions options = {}) {
    io::TexturedMesh textured;
    textured.positions = mesh.positions_mm;
    textured.triangles = mesh.triangles;
    textured.material_of_triangle.assign(mesh.triangles.size(), 0);
    textured.materials.resize(1);
    return repair_mesh(textured, options);
}

bool says(const RepairedMesh& mesh, std::string_view words) {
    return std::ranges::any_of(mesh.report.messages,
                               [&](const std::string& m) { return m.find(words) != std::string::npos; });
}

const SolidMesh box = shapes::box({0, 0, 0}, {15, 10, 6});  // pairs of triangles: -z, +z, -y, +y, -x, +x

/// The upper half of a ball.
SolidMesh dome() {
    SolidMesh mesh = shapes::sphere(5, 12);
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return std::ranges::any_of(t, [&](std::uint32_t v) { return mesh.positions_mm[v].z() < -1e-9; });
    });
    return shapes::with_sources(mesh);
}

}  // namespace

TEST_CASE("A body with a hole, a sheet, and what is neither are told apart") {
    using enum OpenPiece::Kind;
    CHECK(pieces_of(box).empty());
    CHECK(kind_of_one(without(box, {0, 1})) == body);        // no floor
    CHECK(kind_of_one(without(box, {2})) == body);           // a triangle
    CHECK(kind_of_one(without(box, {0, 1, 2, 3})) == body);  // a tube: as large as its walls, and flat
    CHECK(kind_of_one(without(box, {0, 1, 4, 5})) == torn);  // two sides that meet
    CHECK(kind_of_one(dome()) == body);                      // half of its own area, flat
    CHECK(kind_of_one(terrain(12, hills)) == sheet);
    CHECK(kind_of_one(terrain(12, [](double, double) { return 1.0; })) == sheet);
    // A hill with a flat border is a sheet: its floor would lie in it.
    CHECK(kind_of_one(terrain(12, [](double x, double y) { return std::max(0.0, 3 - std::hypot(x - 5, y - 5)); })) ==
          sheet);
    // A plate without its floor is nearly as large as that.
    CHECK(kind_of_one(without(shapes::box({0, 0, 0}, {100, 100, 2}), {0, 1})) == body);
    const SolidMesh both = shapes::joined(without(box, {0, 1}), shapes::moved(terrain(8, hills), Vector3d(30, 0, 0)));
    const std::vector<OpenPiece> two = pieces_of(both);
    REQUIRE(two.size() == 2);
    CHECK(two[0].kind == body);
    CHECK(two[1].kind == sheet);
}

TEST_CASE("The other side of a sheet closes it, in its place or behind it") {
    for (const double thickness : {0.0, 0.5}) {
        SolidMesh sheet = terrain(16, hills);
        const double area_of = pieces_of(sheet)[0].own_mm2;
        add_other_side(sheet, pieces_of(sheet)[0], thickness);
        CHECK(open_edges(sheet.triangles) == 0);
        CHECK(sheet.source_triangle.size() == sheet.triangles.size());
        CHECK(std::ranges::all_of(sheet.source_triangle, [](std::int32_t s) { return s >= 0; }));
        CHECK(shapes::volume(sheet) == Approx(thickness * area_of).epsilon(0.06).margin(1e-9));
    }
    // Even, however steep: at 45 degrees, too.
    SolidMesh slope = terrain(6, [](double x, double) { return x; });
    add_other_side(slope, pieces_of(slope)[0], 0.5);
    CHECK(shapes::volume(slope) == Approx(0.5 * 100 * std::sqrt(2.0)));
    CHECK(shapes::winding_number(slope, {5, 5, 5 - 0.3}) == 1);
    CHECK(shapes::winding_number(slope, {5, 5, 5 + 0.1}) == 0);
}

TEST_CASE("A terrain without a base is a sheet and no lump") {
    const RepairedMesh thin = repaired(terrain(12, hills));
    CHECK(thin.solid->triangles.size() == 2 * 2 * 144);
    CHECK(shapes::volume(*thin.solid) == Approx(0).margin(1e-9));
    CHECK(says(thin, "1 open sheet is no body and encloses nothing (100 % of the surface)"));
    CHECK(says(thin, "--sheet-thickness"));
    CHECK_FALSE(says(thin, "hole"));
    RepairOptions thick;
    thick.sheet_mm = 0.4;
    const RepairedMesh sheet = repaired(terrain(12, hills), thick);
    CHECK(shapes::volume(*sheet.solid) > 0.35 * 100);
    CHECK(says(sheet, "with a thickness of 0.4 mm"));
    RepairOptions filled;
    filled.mode = RepairMode::fill;
    CHECK(says(repaired(terrain(12, hills), filled), "hole was closed"));
    // With two sides it was closed before, and is as thin; or as thick as is asked for.
    SolidMesh two_sided = terrain(12, hills);
    for (std::size_t t = 0, n = two_sided.triangles.size(); t < n; ++t)
        two_sided.triangles.push_back(
            {two_sided.triangles[t][0], two_sided.triangles[t][2], two_sided.triangles[t][1]});
    two_sided = shapes::with_sources(two_sided);
    CHECK(says(repaired(two_sided), "sheets with two sides"));
    CHECK(std::abs(shapes::volume(*repaired(two_sided, thick).solid)) > 0.35 * 100);
}

TEST_CASE("A sheet beside a body keeps to itself") {
    SolidMesh cape;
    cape.positions_mm = {{3, 12, 0}, {12, 12, 0}, {12, 12, 6}, {3, 12, 6}};
    cape.triangles = {{0, 1, 2}, {0, 2, 3}};
    const RepairedMesh mesh = repaired(shapes::joined(box, cape));
    CHECK(shapes::volume(*mesh.solid) == Approx(900));
    CHECK(mesh.solid->triangles.size() == 16);
    CHECK(says(mesh, "1 open sheet"));
}

TEST_CASE("A body of which half is missing is refused with what to do, or said") {
    const SolidMesh torn = without(box, {0, 1, 4, 5});
    CHECK_THROWS_WITH(repaired(torn), Catch::Contains("open at 6 edges") && Catch::Contains("% as much surface") &&
                                          Catch::Contains("--repair fill") && Catch::Contains("--sheet-thickness"));
    RepairOptions options;
    options.mode = RepairMode::fill;
    const RepairedMesh filled = repaired(torn, options);
    CHECK(says(filled, "% of the model's"));
    CHECK(filled.report.after.open_edges == 0);
    options = {};
    options.sheet_mm = 1;
    CHECK(says(repaired(torn, options), "with a thickness of 1 mm"));
    // A small part of the model does not stop it.
    const RepairedMesh beside =
        repaired(shapes::joined(shapes::moved(torn, Vector3d(0, 30, 0)), shapes::box({40, 0, 0}, {90, 50, 50})));
    CHECK(says(beside, "hole was closed"));
    // Nor does a thickness for open sheets make one of it: a coat that is open at the waist is none.
    const RepairedMesh with_sheets = repaired(
        shapes::joined(shapes::moved(torn, Vector3d(0, 30, 0)), shapes::box({40, 0, 0}, {90, 50, 50})), options);
    CHECK(with_sheets.solid->triangles.size() == beside.solid->triangles.size());
    CHECK(shapes::volume(*with_sheets.solid) == Approx(shapes::volume(*beside.solid)));
    // A floor is closed as before, with its share.
    CHECK(says(repaired(without(box, {0, 1})), "150 mm^2 of new surface, 33 % of the model's"));
}
