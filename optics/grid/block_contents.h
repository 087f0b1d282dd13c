// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the blocks of a window hold, by one reading of the volume, and which of their cells are solid by it
// (viewing_grid.h says when).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "optics/grid/viewing_grid.h"
#include "optics/scene/scene.h"

namespace voxtone::optics {

class BlockContents {
public:
    /// Of all places of the frame's lattice. Throws Cancelled.
    BlockContents(const Scene& scene, const GridFrame& frame, const Progress* progress);

    struct Block {
        std::int16_t material = 0;     ///< the only one besides air, -1: several, 0: none
        bool full = false;             ///< no air
        bool closed = false;           ///< full, but for what sticks out of the volume into a sheet
        std::uint8_t rings = 0;        ///< of blocks below, in which light becomes diffuse: the most of what it holds
        std::uint32_t first_fill = 0;  ///< of its 64 cells, where it has resin and air
        [[nodiscard]] bool empty() const { return material == 0; }
    };
    [[nodiscard]] std::size_t size() const { return blocks_.size(); }
    [[nodiscard]] const Block& operator[](std::size_t place) const { return blocks_[place]; }
    [[nodiscard]] const Block& operator[](const Place& block) const { return blocks_[at3(block, frame_.lattice)]; }

    /// Voxels of resin in a cell of the lattice; none beyond.
    [[nodiscard]] int fill_of(const Place& cell) const;
    [[nodiscard]] bool is_solid(const Place& cell) const;
    /// Which neighbour a cell that is not solid gives its resin to.
    [[nodiscard]] Place receiver(const Place& cell) const;

private:
    class Reader;
    const GridFrame& frame_;
    int in_cell_;
    std::vector<Block> blocks_;
    std::vector<std::uint8_t> fills_;
};

}  // namespace voxtone::optics
