// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boxes and upright cylinders of one mixture of resins throughout, halftoned in the print's coordinates by its screen.
//
// A voxel belongs to the cylinder that holds its centre; a box is all of its grid.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/mixture.h"
#include "slicer/layers/layer_source.h"
#include "slicer/layers/mixture_fill.h"

namespace voxtone::slicer {

class PlainBody final : public LayerSource {
public:
    /// `diameter_mm`: of a cylinder about the grid's middle; 0: a box. `resins`: that are loaded, in
    /// [1, halftone::max_resins].
    PlainBody(const VoxelGrid& grid, double diameter_mm, const halftone::CumulativeMixture& mixture, int resins,
              halftone::BlueNoiseScreen screen);

    [[nodiscard]] const VoxelGrid& grid() const override { return grid_; }
    [[nodiscard]] int slab_layers() const override { return 1; }
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override;
    /// Each copy is screened where it stands.
    [[nodiscard]] std::unique_ptr<const SlabLayers> slab_layers_of(int slab, int k_begin, int k_end,
                                                                   std::span<const std::array<int, 3>> places,
                                                                   LayerCounts& counts) const override;

    /// First voxel of the row, counted from its left end; as many are left out at its right end. Half the row or more:
    /// it has none.
    [[nodiscard]] int margin(int j) const;
    /// Without a layer being made.
    [[nodiscard]] std::uint64_t voxels_of_layer() const;

private:
    class Rows;
    VoxelGrid grid_;
    double diameter_mm_;
    MixtureFill fill_;
};

/// Of shares of the loaded resins, by volume; they count against their sum. Contract: each >= 0, one of them > 0.
[[nodiscard]] halftone::CumulativeMixture cumulative_mixture(std::span<const double> shares);

}  // namespace voxtone::slicer
