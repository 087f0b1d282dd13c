// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blocks of a viewing grid cut into parts no larger than voxels, and what their parts hold.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/grid/viewing_grid.h"
#include "optics/media/resin_volume.h"

namespace voxtone::optics {

/// Longer voxels are cut along their axis: a J750's along y, into two that are as long as along x. With whole ones the
/// suite's mean was 0.67 for 0.50 (docs/decisions/008).
inline constexpr double finest_part_mm = 0.0425;

/// Into how many parts a cell of so many voxels is cut along each axis: into voxels, or pieces of voxels where these
/// are longer than `finest_part_mm`.
[[nodiscard]] std::array<int, 3> parts_of_cell(const std::array<int, 3>& view_voxels,
                                               const std::array<double, 3>& pitch_mm);

/// Cuts these blocks, ascending, of a grid that was filled with this volume (homogenisation.h), and fills their parts.
/// Where they hold more than `most_contents` different things (at least whole resins and nothing), the rest are taken
/// to be full of one of their resins. Throws Cancelled, with the grid of no use any more.
void refine(ViewingGrid& grid, const ResinVolume& volume, std::span<const std::uint32_t> blocks,
            const std::array<int, 3>& split, const Progress* progress = nullptr, std::size_t most_contents = 65536);

}  // namespace voxtone::optics
