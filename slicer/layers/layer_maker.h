// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the body to printed layers: solid -> surface shell -> one resin per voxel -> runs. The resins of the shell are
// screened mixtures that make a target colour, or the layers of stacks wrapped around the body.
//
// Any number of threads and any choice of layers give the same bits. With the blue-noise screen a slab is one layer of
// shell blocks, made row of blocks by row of blocks in a strip that stays in cache; air and core are never touched
// voxel by voxel. Error diffusion needs whole layers and has slabs of its own length.
#pragma once

#include <memory>

#include "slicer/layers/block_fill.h"
#include "slicer/layers/layer_sources.h"

namespace voxtone::slicer {

class LayerMaker final : public LayerSource {
public:
    explicit LayerMaker(const LayerSources& sources);

    [[nodiscard]] const VoxelGrid& grid() const override { return sources_.solid.grid(); }
    [[nodiscard]] int slab_layers() const override;
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override;
    /// Each copy is screened where it stands; error diffusion and stacks are the same everywhere.
    [[nodiscard]] std::unique_ptr<const SlabLayers> slab_layers_of(int slab, int k_begin, int k_end,
                                                                   std::span<const std::array<int, 3>> places,
                                                                   LayerCounts& counts) const override;

private:
    LayerCounts make_screened(int slab, int first, int last, const LayerSink& sink) const;
    /// Null: by error diffusion.
    [[nodiscard]] std::unique_ptr<BlockFill> block_fill() const;
    [[nodiscard]] bool by_blocks() const;

    LayerSources sources_;
    bool all_core_;  ///< one colour, and it is that of the core: no voxel needs a look
};

}  // namespace voxtone::slicer
