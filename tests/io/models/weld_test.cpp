// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/weld.h"

#include <catch2/catch.hpp>

using namespace voxtone::io;
using Eigen::Vector3d;

TEST_CASE("Positions that are equal become one, in the order of their first use", "[models]") {
    std::vector<Vector3d> positions{{9, 9, 9}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {7, 7, 7}};
    std::vector<std::array<std::uint32_t, 3>> triangles{{3, 1, 2}, {4, 5, 0}};
    weld_positions(positions, triangles);
    CHECK(positions == std::vector<Vector3d>{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}});
    CHECK(triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {1, 2, 3}});
}

TEST_CASE("Minus zero is zero, and what differs in the last bit stays apart", "[models]") {
    const double next = std::nextafter(1.0, 2.0);
    std::vector<Vector3d> positions{{0.0, -0.0, 1}, {-0.0, 0.0, 1}, {0, 0, next}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
    std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
    weld_positions(positions, triangles);
    CHECK(positions.size() == 4);
    CHECK(triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 0, 1}, {2, 0, 3}});
    CHECK_FALSE(std::signbit(positions[0].y()));
}

TEST_CASE("Many positions are welded as few are", "[models]") {
    // A grid of squares, every triangle with corners of its own.
    constexpr int n = 60;
    std::vector<Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const auto corner = [&](int x, int y) {
        positions.emplace_back(0.1 * x, 0.1 * y, 0);
        return static_cast<std::uint32_t>(positions.size() - 1);
    };
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            triangles.push_back({corner(x, y), corner(x + 1, y), corner(x, y + 1)});
            triangles.push_back({corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)});
        }
    const auto before = positions;
    const auto triangles_before = triangles;
    weld_positions(positions, triangles);
    CHECK(positions.size() == (n + 1) * (n + 1));
    bool same = true;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) same = same && positions[triangles[t][c]] == before[triangles_before[t][c]];
    CHECK(same);
    std::vector<Vector3d> none;
    std::vector<std::array<std::uint32_t, 3>> no_triangles;
    weld_positions(none, no_triangles);
    CHECK(none.empty());
}

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Two squares side by side, of two triangles each and with corners of their own; the second is moved.
std::vector<Vector3d> two_squares(const Vector3d& moved) {
    std::vector<Vector3d> all{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
    for (std::size_t v = 4; v < 8; ++v) all[v] += moved;
    return all;
}
const Triangles squares{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};

std::vector<Rounding> roundings(float first, float second) {
    std::vector<Rounding> all(8, {1, first});
    for (std::size_t v = 4; v < 8; ++v) all[v] = {2, second};
    return all;
}

/// How many vertices are left when equal ones are one.
std::size_t left(std::vector<Vector3d> positions, const std::vector<Rounding>& rounding) {
    Triangles triangles = squares;
    close_cracks(positions, triangles, rounding);
    weld_positions(positions, triangles);
    return positions.size();
}

}  // namespace

TEST_CASE("Pieces that rounding took apart are joined, others are not", "[models]") {
    const Vector3d apart(0.01, 0.01, -0.01);
    CHECK(left(two_squares(apart), roundings(0.01f, 0.01f)) == 6);
    CHECK(left(two_squares(apart), roundings(0.02f, 0)) == 6);  // the other was not rounded
    CHECK(left(two_squares(apart), roundings(0.005f, 0.005f)) == 8);
    CHECK(left(two_squares(apart), roundings(0, 0)) == 8);
    CHECK(left(two_squares({0, 0, 0}), roundings(0, 0)) == 6);
    std::vector<Rounding> one_piece(8, {1, 0.1f});
    CHECK(left(two_squares(apart), one_piece) == 8);
    // A step as large as the squares: each vertex has at most one of the other piece, and none of its own.
    CHECK(left(two_squares(apart), roundings(4, 4)) >= 4);
}
