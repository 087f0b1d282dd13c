// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the voxels of the surface shell come by their materials: block by block, each by itself. Mixtures and a screen
// (block_mixtures.h) or the layers of a stack (wrapped_layers.h).
#pragma once

#include <cstdint>

#include "voxtone/io/layers/layer_runs.h"
#include "voxtone/slicer/surface/surface_shell.h"

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

/// Calls visit(row, lane) for the shell voxels of a block, row by row.
template <class Visit>
void for_each_shell_voxel(const ShellBlock& block, Visit&& visit) {
    for (int row = 0; row < block.size[1] * block.size[2]; ++row)
        for (unsigned bits = block.shell[row]; bits != 0; bits &= bits - 1) visit(row, __builtin_ctz(bits));
}

/// Of one thread.
class BlockFill {
public:
    virtual ~BlockFill() = default;
    /// Writes the material of each shell voxel of the block to out[row * ShellBlock::width + lane], leaves the others
    /// alone and adds voxels and times to `counts`.
    virtual void fill(const ShellBlock& block, io::Material* out, LayerCounts& counts) = 0;
};

}  // namespace voxtone::slicer
