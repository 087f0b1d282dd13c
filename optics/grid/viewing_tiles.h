// SPDX-License-Identifier: GPL-3.0-or-later
//
// A large body cut into tiles, so that a sequence of predictions holds the cells and equations of one at a time.
//
// The lattice of blocks (viewing_grid.h) is halved across its longest edge, so that either half has as much surface,
// until no part has more than `most_cells` surface cells. A tile's window reaches `halo` blocks farther on every side
// where the body may go on, and one for the ghosts. The cut depends on the shape and most_cells alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "optics/grid/viewing_grid.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

struct ViewingTile {
    ViewingWindow window;
    std::array<int, 3> begin{}, end{};  ///< blocks of its own, in the lattice of the body
    VoxelBox voxels;                    ///< those of its own blocks
    std::vector<std::uint32_t> cells;   ///< the surface cells that lie in them, ascending
    std::vector<std::uint32_t> near;    ///< those, and the ones in the halo
};

/// Each block and each surface cell is in one tile's own. `size`: of the volume. Contract: most_cells >= 1, halo >= 1.
[[nodiscard]] std::vector<ViewingTile> viewing_tiles(const Surface& surface, const std::array<int, 3>& size,
                                                     const std::array<double, 3>& pitch_mm,
                                                     const std::array<int, 3>& view_voxels, std::size_t most_cells,
                                                     int halo);

}  // namespace voxtone::optics
