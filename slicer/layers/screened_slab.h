// SPDX-License-Identifier: GPL-3.0-or-later
//
// A slab whose mixtures are known and not yet screened: what takes long is done once for all copies of a part, and the
// screen, addressed in the print's voxels, makes each copy's own resins of it, row by row.
//
// Memory: 16 bytes a shell voxel of the slab.
#pragma once

#include <cstdint>
#include <vector>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/mixture.h"
#include "slicer/layers/layer_source.h"
#include "slicer/layers/layer_sources.h"

namespace voxtone::slicer {

class ScreenedSlab final : public SlabLayers {
public:
    /// Layers [first, last) of slab `slab` of blocks. Contract: the shell is by colour, with a blue-noise screen.
    ScreenedSlab(const LayerSources& sources, int slab, int first, int last, LayerCounts& counts);
    void push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const override;

private:
    struct Block {
        int column;
        std::size_t rows;  ///< index of its first row's shell and mixtures
    };
    class ScreenedRow;

    const halftone::BlueNoiseScreen& screen_;
    int resins_, width_, slab_, block_height_, block_depth_;
    io::Material core_;
    SpanSlab spans_;
    std::vector<std::vector<Block>> blocks_;    ///< by row of blocks, from the left
    std::vector<std::uint8_t> shell_;           ///< by row of each block
    std::vector<std::uint32_t> first_mixture_;  ///< likewise
    std::vector<halftone::CumulativeMixture> mixture_;
};

}  // namespace voxtone::slicer
