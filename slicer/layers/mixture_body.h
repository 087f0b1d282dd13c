// SPDX-License-Identifier: GPL-3.0-or-later
//
// A solid of one mixture of resins throughout, halftoned in the print's coordinates by its screen: a block, a base or a
// coat whose shape is a mesh. What is thinner than a voxel is as the voxels' centres have it.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <utility>

#include "slicer/layers/layer_source.h"
#include "slicer/layers/mixture_fill.h"
#include "slicer/solid/solid.h"

namespace voxtone::slicer {

class MixtureBody final : public LayerSource {
public:
    MixtureBody(Solid solid, MixtureFill fill) : solid_(std::move(solid)), fill_(std::move(fill)) {}

    [[nodiscard]] const VoxelGrid& grid() const override { return solid_.grid(); }
    [[nodiscard]] int slab_layers() const override { return 16; }
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override;
    /// Each copy is screened where it stands.
    [[nodiscard]] std::unique_ptr<const SlabLayers> slab_layers_of(int slab, int k_begin, int k_end,
                                                                   std::span<const std::array<int, 3>> places,
                                                                   LayerCounts& counts) const override;

private:
    class Rows;
    Solid solid_;
    MixtureFill fill_;
};

}  // namespace voxtone::slicer
