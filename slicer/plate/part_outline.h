// SPDX-License-Identifier: GPL-3.0-or-later
//
// The outline of a part from above, its voxels, and what of the plate parts take whose places are given.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "slicer/part/job_body.h"
#include "slicer/plate/nesting.h"

namespace voxtone::slicer {

/// Edge of the cells in which outlines are laid out: fine enough for a gap of a millimetre.
inline constexpr double nest_cell_mm = 0.5;

/// Cells that a length takes, and cells that lie within it.
[[nodiscard]] int cells_above(double mm);
[[nodiscard]] int cells_within(double mm);

/// Of a part with this grid, nothing yet.
[[nodiscard]] Outline empty_outline(const VoxelGrid& grid);
/// Adds the voxels [begin, end) of its row `j`, counted upward.
void take_voxels(Outline& outline, const VoxelGrid& grid, int j, int begin, int end);

/// What stands above each cell of the plate.
[[nodiscard]] Outline outline_of(const JobBody& body);
/// That the body fills, without those of thin features.
[[nodiscard]] std::uint64_t voxels_of(const JobBody& body);

/// Adds an outline whose corner lies at a place that is no whole number of cells. Beyond the plate: left out.
void take_at(Outline& plate, const Outline& outline, double x_mm, double y_mm);

}  // namespace voxtone::slicer
