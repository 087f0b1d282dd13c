// SPDX-License-Identifier: GPL-3.0-or-later
//
// What has layers of voxels: a body's coloured shell and core, boxes of resin, a stack that is there already. A print
// places such parts in its own grid; a part knows its own voxels alone.
#pragma once

#include <functional>

#include "io/layers/layer_runs.h"
#include "slicer/layers/layer_counts.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

/// Takes finished layers, from the bottom up.
using LayerSink = std::function<void(int k, const io::LayerRuns& layer)>;

class LayerSource {
public:
    LayerSource() = default;
    LayerSource(const LayerSource&) = delete;
    LayerSource& operator=(const LayerSource&) = delete;
    virtual ~LayerSource() = default;

    /// The voxels of all layers, in the printer's pitch.
    [[nodiscard]] virtual const VoxelGrid& grid() const = 0;
    /// Layers are made in slabs of so many, the first from layer 0. A slab depends on nothing but its own index.
    [[nodiscard]] virtual int slab_layers() const = 0;
    /// Makes the layers of [k_begin, k_end) that lie in this slab, from the bottom up, and hands each to `sink`. May be
    /// called from any thread, for different slabs at once.
    virtual LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const = 0;
};

}  // namespace voxtone::slicer
