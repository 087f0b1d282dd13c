// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the cells of a viewing grid hold: the composition of each is counted, equal ones get one number.
//
// A composition is the counts of materials in the layers of a cell, across the way to the surface. Where there are more
// than 65,534 different ones, layers are forgotten; where these are too many still, shares are rounded to eighths, up
// or down by a chance that keeps them on average (many_mixtures_test). Where resin runs sideways (lateral_spread.h) a
// cell has shares of its own from the first, without layers: in 96 parts, in 24 or in eighths. Whole cells of six
// voxels (J750 High Mix) of five resins are of less than 5,000 kinds.
#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "optics/grid/viewing_grid.h"
#include "optics/media/resin_volume.h"

namespace voxtone::optics {

/// Takes the resins of a volume of the same shape. False, and nothing done, where a block without transport cells has
/// got other materials; those are marked in `wanted`, one byte per place of the lattice. Throws Cancelled, with the
/// grid of no use any more.
[[nodiscard]] bool homogenise(ViewingGrid& grid, const ResinVolume& volume, std::vector<std::uint8_t>& wanted,
                              const Progress* progress = nullptr);

}  // namespace voxtone::optics
