// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace voxtone::slicer {

/// Counts of one or more slabs of layers.
struct LayerCounts {
    std::uint64_t body_voxels = 0;
    std::uint64_t shell_voxels = 0;
    std::uint64_t thin_voxels = 0;  ///< added because the feature was thinner than a voxel
    /// Where the time went, seconds summed over threads.
    double solid_s = 0, shell_s = 0, colour_s = 0, screen_s = 0, runs_s = 0;
    LayerCounts& operator+=(const LayerCounts& other);
};

}  // namespace voxtone::slicer
