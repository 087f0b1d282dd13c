// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers of varying thickness wrapped around a body, directly on the print voxels.
// Based on: M. Hasan, M. Fuchs, W. Matusik, H. Pfister, S. Rusinkiewicz, "Physical reproduction of materials with
// specified subsurface scattering", SIGGRAPH 2010, Sec. 7.2, with exact distances to the surface in the place of a
// distance transform and without meshes between.
//
// A voxel takes the layer that its distance to the surface falls in at the nearest surface point; below the layers
// comes the base. Layers from two sides of a thin part meet where both are equally far.
//
// Borders between layers fall between voxels, and layers may be thinner than one. So the distance is taken at one depth
// of the voxel's extent along the surface normal, chosen by the blue-noise screen: with e the sum of |n_axis|
// pitch_axis over the axes and t in (0, 1) the voxel's threshold, at d + (t - 1/2) e. A voxel gets each layer with the
// share that the layer has of it, the mean thickness of a layer on a flat surface is exact, and a border is off by less
// than one voxel at any place. (The voxel's centre alone would be within half a voxel everywhere, but wrong by the same
// amount all over a flat side.) Distances count from the model's surface; what the printed body has beyond it by its
// own rounding, up to half a voxel, is given to the topmost layer.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "halftone/screens/blue_noise_screen.h"
#include "scattering/design/layer_fields.h"
#include "scattering/print/map_placement.h"
#include "slicer/layers/block_fill.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::scattering {

class WrappedLayers final : public slicer::ShellFill {
public:
    /// `materials`: what the materials of the fields are printed with. Keeps references to all but these.
    WrappedLayers(const slicer::VisibleSurface& surface, const slicer::VoxelGrid& grid, const LayerFields& fields,
                  const MapPlacement& placement, const halftone::BlueNoiseScreen& screen,
                  std::vector<io::Material> materials, io::Material base);

    [[nodiscard]] double shell_mm() const override { return shell_mm_; }
    [[nodiscard]] const LayerFields& fields() const { return fields_; }
    /// Where on the map a point of a visible triangle lies, by its place in the source triangle; mm.
    [[nodiscard]] Eigen::Vector2f map_point(std::uint32_t triangle, float u, float v) const {
        return placement_.at(surface_.source_triangle[triangle], u, v);
    }
    /// Of a layer, or of the base for layers().
    [[nodiscard]] io::Material material(std::size_t layer) const { return layer_material_[layer]; }
    [[nodiscard]] std::unique_ptr<slicer::BlockFill> block_fill() const override;

private:
    class Fill;
    const slicer::VisibleSurface& surface_;
    const LayerFields& fields_;
    const MapPlacement& placement_;
    const halftone::BlueNoiseScreen& screen_;
    std::vector<io::Material> layer_material_;  ///< the base last
    std::vector<float> voxel_extent_mm_;        ///< along the normal of each visible triangle
    double shell_mm_;
};

}  // namespace voxtone::scattering
