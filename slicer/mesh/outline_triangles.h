// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies within outlines, cut into triangles without new corners: the constrained Delaunay triangulation of all of
// them together (CGAL; L. P. Chew, "Constrained Delaunay triangulations", Algorithmica 4 (1989)), of which the
// triangles are kept that lie behind an odd number of outlines, seen from outside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

/// Each at least three corners.
using Outline = std::vector<Eigen::Vector2d>;

/// Counterclockwise triangles by corners, counted through all outlines in their order. The outlines must neither cross
/// nor touch each other or themselves; which way round they go does not matter.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> outline_triangles(std::span<const Outline> outlines);

}  // namespace voxtone::slicer
