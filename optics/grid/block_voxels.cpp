// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/block_voxels.h"

#include "optics/media/mirrored_box.h"

namespace voxtone::optics {

BlockVoxels::BlockVoxels(const ViewingGrid& grid, const ResinVolume& volume)
    : grid_(grid),
      volume_(volume),
      view_(grid.view_voxels),
      extent_(grid.block_voxels()),
      spread_(volume, grid.mirrored, grid.spread, grid.resins),
      given_(spread_) {}

void BlockVoxels::enter_block(std::size_t t) {
    block_ = &grid_.transport_block(t);
    corner_ = grid_.corner_of(block_->at);
    axis_ = grid_.towards[t] / 2u;
    plus_ = grid_.towards[t] % 2 == 1;
    if (spreads())
        spread_.read(corner_, extent_);
    else
        read_box(volume_, grid_.mirrored, corner_, extent_, box_);
}

void BlockVoxels::read_donor(const Place& from) {
    if (spreads())
        given_.read(from, view_);
    else
        read_box(volume_, grid_.mirrored, from, view_, donor_);
}

}  // namespace voxtone::optics
