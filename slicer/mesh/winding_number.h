// SPDX-License-Identifier: GPL-3.0-or-later
//
// Winding numbers of a closed chain at many single points off the surface: signed crossings along rays parallel to the
// axes, two of three rays deciding; where rays run into edges, the sum of solid angles decides.
//
// Own code because shells nest and overlap here: CGAL's Side_of_triangle_mesh counts crossings without their sign, so
// it tells inside from outside by parity alone; the fast winding numbers of libigl come with no package of Debian 12.
#pragma once

#include <Eigen/Core>

#include "slicer/mesh/triangle_tree.h"
#include "slicer/mesh/work_budget.h"

namespace voxtone::slicer {

/// Of the triangles of a tree; may be called from any thread. `work`: what looking at triangles is spent from, where
/// that is to be bounded; WorkExceeded is thrown then.
[[nodiscard]] int winding_number(const TriangleTree& tree, const Eigen::Vector3d& p, WorkBudget* work = nullptr);

}  // namespace voxtone::slicer
