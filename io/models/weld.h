// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vertices with the same position become one, so that it is known which triangles hang together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

/// Joins positions that are equal to the bit (-0 counts as 0), renumbers the triangles, and drops positions that no
/// triangle uses. The order of first use is kept. Indices must be in range.
void weld_positions(std::vector<Eigen::Vector3d>& positions, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace voxtone::io
