// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/painted_triangles.h"

#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

using namespace voxtone::io;
using Eigen::Vector3d;

namespace {

const std::vector<Vector3d> square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};

std::vector<PaintInput> two(std::string_view first, std::string_view second = {}) {
    return {{{{0, 1, 2}, 0}, first}, {{{0, 2, 3}, 9}, second}};
}

double area(const PaintedMesh& mesh, const PaintedTriangle& t) {
    const Vector3d &a = mesh.vertices[t.corners[0]], &b = mesh.vertices[t.corners[1]], &c = mesh.vertices[t.corners[2]];
    return (b - a).cross(c - a).z() / 2;
}

/// By extruder, of the first triangle.
std::map<int, double> areas(const PaintedMesh& mesh) {
    std::map<int, double> sums;
    for (std::size_t i = mesh.first[0]; i < mesh.first[1]; ++i)
        sums[mesh.pieces[i].extruder] += area(mesh, mesh.pieces[i]);
    return sums;
}

/// Extruder at a place within the first triangle.
int at(const PaintedMesh& mesh, double x, double y) {
    for (std::size_t i = mesh.first[0]; i < mesh.first[1]; ++i) {
        const auto& t = mesh.pieces[i].corners;
        bool inside = true;
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3d &a = mesh.vertices[t[c]], &b = mesh.vertices[t[(c + 1) % 3]];
            inside = inside && (b - a).cross(Vector3d(x, y, 0) - a).z() > 0;
        }
        if (inside) return mesh.pieces[i].extruder;
    }
    return -1;
}

/// How many sides are of one piece alone: 4 of a closed square.
std::size_t open_length(const PaintedMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const PaintedTriangle& t : mesh.pieces)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = t.corners[c], b = t.corners[(c + 1) % 3];
            sides[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    double length = 0;
    for (const auto& [side, sum] : sides)
        if (sum != 0) length += (mesh.vertices[side.first] - mesh.vertices[side.second]).norm();
    return static_cast<std::size_t>(std::lround(length));
}

}  // namespace

TEST_CASE("A painted triangle is cut where its slicer cuts it", "[models]") {
    // Triangle (0, 0), (4, 0), (4, 4). Four parts: the last digit but one is of the first corner's child.
    const PaintedMesh four = cut_by_paint(square, two("48883"));
    CHECK(four.first == std::vector<std::size_t>{0, 4, 6});  // the neighbour shares the diagonal
    CHECK(areas(four) == std::map<int, double>{{1, 2.0}, {2, 6.0}});
    CHECK(at(four, 1, 0.4) == 1);
    CHECK(at(four, 3.5, 0.5) == 2);
    const PaintedMesh second = cut_by_paint(square, two("84883"));
    CHECK(at(second, 3.5, 0.5) == 1);
    CHECK(at(second, 1, 0.4) == 2);
    CHECK(at(cut_by_paint(square, two("88483")), 3.8, 3.4) == 1);
    CHECK(at(cut_by_paint(square, two("88843")), 3, 1.5) == 1);
    // One side: that across the first corner, the second, the third.
    const PaintedMesh one = cut_by_paint(square, two("481"));
    CHECK(at(one, 3.5, 0.5) == 1);
    CHECK(at(one, 3.5, 3) == 2);
    CHECK(areas(one) == std::map<int, double>{{1, 4.0}, {2, 4.0}});
    const PaintedMesh across_second = cut_by_paint(square, two("485"));
    CHECK(at(across_second, 3.8, 3) == 1);
    CHECK(at(across_second, 1, 0.5) == 2);
    CHECK(at(cut_by_paint(square, two("489")), 1, 0.7) == 1);
    // Two sides: the corner itself, then what is beside it.
    const PaintedMesh corner = cut_by_paint(square, two("4882"));
    CHECK(areas(corner) == std::map<int, double>{{1, 2.0}, {2, 6.0}});
    CHECK(at(corner, 1, 0.4) == 1);
    CHECK(at(cut_by_paint(square, two("4886")), 3.5, 0.5) == 1);
    CHECK(at(cut_by_paint(square, two("488A")), 3.8, 3.4) == 1);
    // A leaf of two digits, the fourth filament's.
    CHECK(areas(cut_by_paint(square, two("481C83"))) == std::map<int, double>{{1, 2.0}, {2, 4.0}, {4, 2.0}});
}

TEST_CASE("What is cut up stays closed, across corners in one place and several levels", "[models]") {
    for (const std::string_view paint : {"48883", "481", "485", "489", "4882", "4886", "488A", "48848883381"}) {
        CAPTURE(paint);
        CHECK(open_length(cut_by_paint(square, two(paint))) == 16);
        CHECK(open_length(cut_by_paint(square, two("0", paint))) == 16);
        CHECK(open_length(cut_by_paint(square, two("48883", paint))) == 16);
    }
    // Corners of their own for each triangle.
    std::vector<Vector3d> apart{square[0], square[1], square[2], square[0], square[2], square[3]};
    const PaintedMesh mesh =
        cut_by_paint(apart, std::vector<PaintInput>{{{{0, 1, 2}, 0}, "48883"}, {{{3, 4, 5}, 0}, ""}});
    CHECK(mesh.first == std::vector<std::size_t>{0, 4, 6});
    CHECK(mesh.vertices.size() == 9);
    std::vector<PaintInput> stays = two("48883");
    stays[1].stays = true;
    CHECK(cut_by_paint(square, stays).first == std::vector<std::size_t>{0, 4, 5});
    CHECK(cut_by_paint(square, two("4X3")).first == std::vector<std::size_t>{0, 1, 2});
}
