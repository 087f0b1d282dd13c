// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mixtures that the shell voxels of one block ask for: target colour at the nearest surface point, separated; or what
// the appearance loop found for them.
#pragma once

#include <array>
#include <cstddef>

#include "voxtone/halftone/separation.h"
#include "voxtone/slicer/skin_source.h"
#include "voxtone/slicer/surface_colour.h"
#include "voxtone/slicer/surface_shell.h"
#include "voxtone/slicer/visible_surface.h"

namespace voxtone::slicer {

/// Calls visit(row, lane) for the shell voxels of a block in the order in which `BlockMixtures` lists them.
template <class Visit>
void for_each_shell_voxel(const ShellBlock& block, Visit&& visit) {
    for (int row = 0; row < block.size[1] * block.size[2]; ++row)
        for (unsigned bits = block.shell[row]; bits != 0; bits &= bits - 1) visit(row, __builtin_ctz(bits));
}

class BlockMixtures {
public:
    /// `skin`: null: separate the target colours.
    BlockMixtures(const VisibleSurface& surface, const SurfaceColour& colour, const halftone::Separation& separation,
                  const SkinSource* skin)
        : surface_(surface), colour_(colour), separation_(separation), skin_(skin) {}

    /// Looks up what the voxels of the block ask for; returns how many there are.
    std::size_t gather(const ShellBlock& block);
    /// Separates them; valid until the next call of `gather`.
    const halftone::CumulativeMixture* separate();

private:
    static constexpr std::size_t max_voxels = std::size_t(ShellBlock::max_rows) * ShellBlock::width;
    const VisibleSurface& surface_;
    const SurfaceColour& colour_;
    const halftone::Separation& separation_;
    const SkinSource* skin_;
    std::size_t count_ = 0;
    std::array<float, max_voxels> red_, green_, blue_;
    std::array<halftone::CumulativeMixture, max_voxels> mixture_;
};

}  // namespace voxtone::slicer
