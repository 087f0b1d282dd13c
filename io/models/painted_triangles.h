// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangles that were painted in parts in a slicer, cut up as the slicer cuts them (TriangleSelector of PrusaSlicer and
// its kin): divided sides at their middles. With the corners a, b, c from where the division begins on,
//   one side (bc):        (a, b, bc), (bc, c, a)
//   two sides (ab, ca):   (a, ab, ca), (ab, b, ca), (b, c, ca)
//   three sides:          (a, ab, ca), (ab, b, bc), (bc, c, ca), (ab, bc, ca).
// What shares a divided side with them is cut there, too, so that a closed mesh stays closed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

struct PaintedTriangle {
    std::array<std::uint32_t, 3> corners{};
    std::uint16_t extruder = 0;  ///< from 1; 0: not painted
};

/// One to be cut. `paint`: what the slicer wrote where it is painted in parts, else empty.
struct PaintInput {
    PaintedTriangle triangle;
    std::string_view paint;
    bool stays = false;  ///< in one piece, whatever its neighbours are
};

struct PaintedMesh {
    std::vector<Eigen::Vector3d> vertices;  ///< those that were given, then middles of sides
    std::vector<std::size_t> first;         ///< of each triangle that was given, and one more: its place in `pieces`
    std::vector<PaintedTriangle> pieces;    ///< as their triangle is turned
};

/// Corners are below the number of vertices. A paint that is no tree (slicer_roles.h) divides nothing.
[[nodiscard]] PaintedMesh cut_by_paint(std::span<const Eigen::Vector3d> vertices,
                                       std::span<const PaintInput> triangles);

}  // namespace voxtone::io
