// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vertices with the same position become one, so that it is known which triangles hang together; and those that
// rounding took apart get the same.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

/// Joins positions that are equal to the bit (-0 counts as 0), renumbers the triangles, and drops positions that no
/// triangle uses. The order of first use is kept. Indices must be in range.
void weld_positions(std::vector<Eigen::Vector3d>& positions, std::vector<std::array<std::uint32_t, 3>>& triangles);

/// How a position was rounded: to steps, on a grid that its piece has for itself.
struct Rounding {
    std::uint32_t piece = 0;
    float step = 0;  ///< in the unit of positions; 0: it was not
};

/// Moves a vertex of an open edge onto the nearest one of an open edge of another piece, where their roundings alone
/// explain how far apart they are: at most half the diagonals of both cells. No two of one piece are joined.
void close_cracks(std::vector<Eigen::Vector3d>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                  std::span<const Rounding> roundings);

}  // namespace voxtone::io
