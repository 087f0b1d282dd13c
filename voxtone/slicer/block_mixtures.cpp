// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/block_mixtures.h"

namespace voxtone::slicer {

std::size_t BlockMixtures::gather(const ShellBlock& block) {
    count_ = 0;
    for_each_shell_voxel(block, [&](int row, int lane) {
        const int at = row * ShellBlock::width + lane;
        if (skin_) {
            mixture_[count_++] = skin_->mixture(block.triangle[at], block.u[at], block.v[at], block.distance_mm[at]);
            return;
        }
        const Eigen::Vector3f rgb = colour_.at(surface_.source_triangle[block.triangle[at]], block.u[at], block.v[at]);
        red_[count_] = rgb.x();
        green_[count_] = rgb.y();
        blue_[count_] = rgb.z();
        ++count_;
    });
    return count_;
}

const halftone::CumulativeMixture* BlockMixtures::separate() {
    if (!skin_) separation_.mixtures(red_.data(), green_.data(), blue_.data(), count_, mixture_.data());
    return mixture_.data();
}

}  // namespace voxtone::slicer
