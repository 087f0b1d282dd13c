// SPDX-License-Identifier: GPL-3.0-or-later
//
// The voxels that cells of a transport block are made of, read block by block: those of the block and of cells that
// gave theirs, or what they hold where resin runs sideways (lateral_spread.h).
#pragma once

#include <cstddef>
#include <vector>

#include "optics/grid/viewing_grid.h"
#include "optics/media/lateral_spread.h"
#include "optics/media/resin_volume.h"

namespace voxtone::optics {

class BlockVoxels {
protected:
    BlockVoxels(const ViewingGrid& grid, const ResinVolume& volume);

    void enter_block(std::size_t t);
    /// The cell of a donor.
    void read_donor(const Place& from);
    /// Index of voxel `in` of a cell of the block among those of the block.
    [[nodiscard]] std::size_t index(const Place& cell, const Place& in) const {
        return at3({cell[0] * view_[0] + in[0], cell[1] * view_[1] + in[1], cell[2] * view_[2] + in[2]}, extent_);
    }
    [[nodiscard]] bool spreads() const { return grid_.spread.any(); }

    const ViewingGrid& grid_;
    const ResinVolume& volume_;
    const Place view_, extent_;  ///< voxels of a cell and of a block
    const GridBlock* block_ = nullptr;
    Place corner_{};
    std::size_t axis_ = 2;  ///< along which light comes, from above where `plus_`
    bool plus_ = true;
    std::vector<Material> box_, donor_;
    SpreadBox spread_, given_;  ///< in their place where resin runs sideways
};

}  // namespace voxtone::optics
