// SPDX-License-Identifier: GPL-3.0-or-later
//
// A slab for as many places as a part stands at: nearest surface and mixtures are found once, and the screen, addressed
// in the print's voxels, makes each copy's own resins of them.
//
// Few places are screened while a block's mixtures are at hand, and their resins are kept: a byte a voxel and place.
// For many, mixtures are kept, two bytes a voxel and resin, and screened row by row.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/mixture.h"
#include "slicer/layers/layer_source.h"
#include "slicer/layers/layer_sources.h"

namespace voxtone::slicer {

class ScreenedSlab final : public SlabLayers {
public:
    /// Layers [first, last) of slab `slab` of blocks, for parts whose corners are at `places` of the print. Contract:
    /// the shell is by colour, with a blue-noise screen.
    ScreenedSlab(const LayerSources& sources, int slab, int first, int last, std::span<const std::array<int, 3>> places,
                 LayerCounts& counts);
    /// Contract: one of the places.
    void push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const override;
    [[nodiscard]] std::size_t memory_bytes() const override;

private:
    static constexpr int lanes = ShellBlock::width;
    /// Of each bound of a mixture the eight voxels' one after the other.
    using Bounds = std::array<std::uint16_t, lanes>;
    using Eight = std::array<io::Material, lanes>;
    class BlockRow;
    class Pieces;

    /// `bottom`: the lowest layer of the blocks.
    void add_block_row(int bj, int bottom, const BlockRow& blocks);
    [[nodiscard]] bool keeps_mixtures() const { return resins_of_.empty(); }
    [[nodiscard]] std::size_t place_of(const std::array<int, 3>& at) const;

    const halftone::BlueNoiseScreen& screen_;
    int width_, rows_, block_height_, first_, layers_;
    std::size_t bounds_;  ///< of a mixture
    io::Material core_;
    SpanSlab spans_;
    std::vector<std::array<int, 3>> places_;
    // By row of voxels, in each the pieces of eight that have voxels of the shell, from the left.
    std::vector<std::uint32_t> row_begin_;
    std::vector<std::int32_t> column_;
    std::vector<std::uint8_t> shell_;            ///< which of the eight are of it, or none
    std::vector<Bounds> mixture_;                ///< `bounds_` a piece, or none
    std::vector<std::vector<Eight>> resins_of_;  ///< by place, or none; core where a voxel is not of the shell
};

}  // namespace voxtone::slicer
