// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the voxels of the surface shell come by their materials: block by block, each by itself. Mixtures and a screen
// (block_mixtures.h), or what a print that shows no colours fills it with (ShellFill).
#pragma once

#include <memory>

#include "io/layers/layer_runs.h"
#include "slicer/layers/layer_counts.h"
#include "slicer/surface/surface_shell.h"

namespace voxtone::slicer {

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

/// What a shell is made of that shows no colours; of all threads.
class ShellFill {
public:
    virtual ~ShellFill() = default;
    /// How far from the surface voxels may be of another material than the core.
    [[nodiscard]] virtual double shell_mm() const = 0;
    [[nodiscard]] virtual std::unique_ptr<BlockFill> block_fill() const = 0;
};

}  // namespace voxtone::slicer
