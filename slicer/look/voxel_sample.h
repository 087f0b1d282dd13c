// SPDX-License-Identifier: GPL-3.0-or-later
//
// Some of a print's voxels for the report's viewer, collected while its layers are made or taken from a volume: every
// step-th along each axis, and some layers whole.
//
// Steps are as small as the number of voxels allows and grow where voxels are closest together; no axis takes a step of
// three before all take one of two. What is taken is deflated layer by layer, so that little is held. Where it takes
// more room than the page has, every second layer is left out, then every second column and row, and so on. The same
// bytes for any number of threads and any order of layers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>

#include "io/layers/layer_runs.h"
#include "io/report/viewer.h"
#include "optics/media/resin_volume.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

class VoxelSample {
public:
    /// The viewer holds two of them a byte.
    static constexpr double most_voxels = 48e6;
    static constexpr int most_whole_layers = 40;

    /// Of `layers` layers from `first`.
    VoxelSample(int first, int layers, const VoxelGrid& grid, double most = most_voxels);

    /// Takes what it needs of the layer. From any thread, once for each layer.
    void offer(int k, const io::LayerRuns& layer);
    /// What it has so far, to be put into another one of the same layers and grid; nothing is left here.
    [[nodiscard]] io::ViewerLayers take_layers();
    void put(const io::ViewerLayers& layers);
    /// What it has, in about `bytes` of the page; nothing is left here.
    [[nodiscard]] io::ViewerVoxels take(std::size_t bytes);

    [[nodiscard]] const std::array<std::uint32_t, 3>& step() const { return step_; }

private:
    [[nodiscard]] bool is_thinned(int k) const { return (k - first_) % int(step_[2]) == 0; }
    [[nodiscard]] bool is_whole(int k) const;

    int first_, layers_;
    VoxelGrid grid_;
    std::array<std::uint32_t, 3> step_{1, 1, 1};
    std::mutex mutex_;
    std::map<int, io::ViewerLayer> thinned_, whole_;
};

/// Of a volume, without whole layers where it is thinned only upward.
[[nodiscard]] io::ViewerVoxels voxels_of(const optics::ResinVolume& volume, std::size_t bytes);

}  // namespace voxtone::slicer
