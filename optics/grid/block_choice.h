// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which blocks of a window have cells, by the rules of viewing_grid.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/grid/block_contents.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

/// How deep below the surface colour is expected, and whether what lies deeper may be in nodes.
struct ColourDepth {
    double mm = 0;
    bool deeper_in_nodes = false;
};

/// One byte per place of the frame's lattice. `also`: places that have cells besides, empty or as many; `requested`:
/// the surface below which colour is expected to come and go, null: all of it. Throws Cancelled.
[[nodiscard]] std::vector<std::uint8_t> blocks_with_cells(const Scene& scene, const GridFrame& frame,
                                                          const BlockContents& contents, const ColourDepth& colour,
                                                          std::span<const std::uint8_t> also, const Surface* requested,
                                                          const Progress* progress);

}  // namespace voxtone::optics
