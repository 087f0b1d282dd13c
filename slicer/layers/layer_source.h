// SPDX-License-Identifier: GPL-3.0-or-later
//
// What has layers of voxels: a body's coloured shell and core, boxes of resin, a stack that is there already. A print
// places such parts in its own grid; a part knows its own voxels alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "io/layers/layer_runs.h"
#include "slicer/layers/layer_counts.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

/// Takes finished layers, from the bottom up.
using LayerSink = std::function<void(int k, const io::LayerRuns& layer)>;

/// That the runs of a layer take, one row of it at least.
[[nodiscard]] std::size_t bytes_of_runs(const io::LayerRuns& layer);

/// Layers of one slab, to be laid down wherever their part stands in a print.
class SlabLayers {
public:
    SlabLayers() = default;
    SlabLayers(const SlabLayers&) = delete;
    SlabLayers& operator=(const SlabLayers&) = delete;
    virtual ~SlabLayers() = default;
    /// Appends row `j`, counted upward, of layer `k` of the part, and leaves it open. `at`: of the part's corner in the
    /// print's voxels, which a screen is addressed in. From any thread.
    virtual void push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const = 0;
    /// That it holds, about.
    [[nodiscard]] virtual std::size_t memory_bytes() const { return 0; }
};

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
    /// Memory that making a slab takes, of slabs that are so large that not every thread may make one; 0: of no others.
    [[nodiscard]] virtual std::uint64_t slab_bytes() const { return 0; }
    /// The same layers for parts whose corners are at `places` of a print, one at least; at {0, 0, 0} they are those
    /// that `make` makes. As it stands here: the same voxels everywhere.
    [[nodiscard]] virtual std::unique_ptr<const SlabLayers> slab_layers_of(int slab, int k_begin, int k_end,
                                                                           std::span<const std::array<int, 3>> places,
                                                                           LayerCounts& counts) const;
};

}  // namespace voxtone::slicer
