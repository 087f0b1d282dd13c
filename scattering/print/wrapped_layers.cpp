// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/wrapped_layers.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/stopwatch.h"

namespace voxtone::scattering {

class WrappedLayers::Fill : public slicer::BlockFill {
public:
    explicit Fill(const WrappedLayers& wrapped) : wrapped_(wrapped) {}
    void fill(const slicer::ShellBlock& block, io::Material* out, slicer::LayerCounts& counts) override {
        Stopwatch watch;
        slicer::for_each_shell_voxel(block, [&](int row, int lane) {
            const int at = row * slicer::ShellBlock::width + lane;
            const std::uint32_t triangle = block.triangle[at];
            const float t =
                (float(wrapped_.screen_.threshold(block.origin[0] + lane, block.origin[1] + row % block.size[1],
                                                  block.origin[2] + row / block.size[1])) +
                 0.5f) /
                65535.0f;
            const float depth =
                std::max(block.distance_mm[at] + (t - 0.5f) * wrapped_.voxel_extent_mm_[triangle], 0.0f);
            const Eigen::Vector2f place = wrapped_.map_point(triangle, block.u[at], block.v[at]);
            out[at] = wrapped_.material(wrapped_.fields_.layer_at(place.x(), place.y(), depth));
            ++counts.shell_voxels;
        });
        counts.screen_s += watch.lap();
    }

private:
    const WrappedLayers& wrapped_;
};

WrappedLayers::WrappedLayers(const slicer::VisibleSurface& surface, const slicer::VoxelGrid& grid,
                             const LayerFields& fields, const MapPlacement& placement,
                             const halftone::BlueNoiseScreen& screen, std::vector<io::Material> materials,
                             io::Material base)
    : surface_(surface), fields_(fields), placement_(placement), screen_(screen) {
    for (std::size_t l = 0; l < fields.layers(); ++l) {
        VOXTONE_EXPECT(fields.material(l) < materials.size());
        layer_material_.push_back(materials[fields.material(l)]);
    }
    layer_material_.push_back(base);
    for (const auto& [a, b, c] : surface.triangles) {
        const Eigen::Vector3d &p = surface.positions_mm[a], &q = surface.positions_mm[b], &r = surface.positions_mm[c];
        voxel_extent_mm_.push_back(static_cast<float>((q - p).cross(r - p).normalized().cwiseAbs().dot(grid.pitch_mm)));
    }
    shell_mm_ = fields.most_depth_mm() + 0.5 * grid.pitch_mm.norm();
}

std::unique_ptr<slicer::BlockFill> WrappedLayers::block_fill() const { return std::make_unique<Fill>(*this); }

}  // namespace voxtone::scattering
