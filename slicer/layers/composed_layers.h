// SPDX-License-Identifier: GPL-3.0-or-later
//
// Several parts in one print, voxel by voxel: each lies a whole number of voxels from the print's corner. Where two
// fill a voxel, it is the one of higher priority that has it, and of equal ones the later in the list. A part that cuts
// leaves air where it would have filled.
//
// A part that stands at several places is made once for each slab of the print and laid down as often; its screen is
// addressed in the print's voxels, so that copies differ in voxels and not in looks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "slicer/layers/layer_source.h"
#include "slicer/layers/part_rows.h"

namespace voxtone::slicer {

struct PlacedPart {
    std::shared_ptr<const LayerSource> layers;  ///< of the print's pitch; may stand elsewhere too
    std::array<int, 3> at{};                    ///< voxels from the corner of the print, each >= 0
    int priority = 0;
    bool cuts = false;  ///< leaves air
    /// Gets its layers as they are here before others are laid over them, from any thread, each as often as it is made.
    LayerSink seen = {};
};

class ComposedLayers final : public LayerSource {
public:
    /// Contract: there is a part, and all lie within the grid.
    ComposedLayers(const VoxelGrid& grid, std::vector<PlacedPart> parts);

    [[nodiscard]] const VoxelGrid& grid() const override { return grid_; }
    [[nodiscard]] int slab_layers() const override { return slab_layers_; }
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override;

    /// Of each part, in the order in which they were given, in all layers that `make` has made, each counted as often.
    [[nodiscard]] std::vector<Overlap> overlapped() const;
    /// The most so far, before the first at most.
    [[nodiscard]] std::uint64_t slab_bytes() const override;
    /// Of each part, what its layers came to; of parts that are made once for several places all stands at the first.
    [[nodiscard]] std::vector<LayerCounts> counted() const;
    /// The same of these layers, which are made for that.
    [[nodiscard]] std::vector<Overlap> overlapped(int k_begin, int k_end) const;

private:
    /// Between these layers; where none do no voxel needs a look.
    [[nodiscard]] bool boxes_overlap(int first, int last) const;

    VoxelGrid grid_;
    std::vector<PlacedPart> parts_;   ///< as given
    std::vector<std::size_t> order_;  ///< in which they are laid down: later ones win
    int slab_layers_;
    mutable std::mutex counting_;
    mutable std::vector<Overlap> lost_;
    mutable std::vector<LayerCounts> counts_;
    mutable std::uint64_t slab_bytes_ = 0;
};

}  // namespace voxtone::slicer
