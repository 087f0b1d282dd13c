// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the triangles of a mesh meet beyond the corners and edges that they share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "slicer/mesh/step_share.h"
#include "slicer/mesh/triangle_tree.h"
#include "slicer/mesh/work_budget.h"

namespace voxtone::slicer {

/// Pairs of triangles without a common corner that meet: crossing, touching, or lying in each other (exact predicates).
/// Triangles without area are left out. Throws WorkExceeded.
/// `bar` advances by a task a triangle.
[[nodiscard]] std::size_t count_crossings(const TriangleTree& tree, WorkBudget& work, StepShare* bar = nullptr);

/// Per triangle the triangles that it crosses or touches other than in the corners they share: those of the pairs
/// above, and those with one common corner that meet beyond it. In ascending order. `bar` advances by a step a
/// triangle. Throws WorkExceeded.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> find_crossings(const TriangleTree& tree, WorkBudget& work,
                                                                     StepShare* bar = nullptr);

}  // namespace voxtone::slicer
