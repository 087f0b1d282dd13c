// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts laid in as few passes of the printer's heads as can be. All that stands on a plate is as high as its highest
// part, so that the printing time, passes times layers, goes by passes alone: parts are looked for room for in a band
// of one strip's width along the heads' way, then of two, until all have found it; within the band they are laid as
// close along it as nesting.h lays them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "slicer/plate/nesting.h"

namespace voxtone::slicer {

/// Of a plate in cells.
struct PassBands {
    int along = 0;        ///< axis of the heads' way: 0 x, 1 y
    int width_cells = 0;  ///< of a strip; 0: not known, the plate is one
};

/// As `nest`. Where `taken` has something, the band begins there.
[[nodiscard]] std::vector<std::optional<NestPlace>> nest_in_passes(const std::vector<NestItem>& items,
                                                                   const std::array<int, 2>& plate, int gap_cells,
                                                                   const std::optional<Outline>& taken,
                                                                   const PassBands& bands);

}  // namespace voxtone::slicer
