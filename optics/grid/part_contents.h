// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the parts of a block's cells hold (refinement.h), in one number each: a few materials, with the twelfths of the
// part that each fills.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/grid/viewing_grid.h"
#include "optics/media/resin_volume.h"

namespace voxtone::optics {

using PartKey = std::uint64_t;
inline constexpr PartKey air_key = 0;
inline constexpr PartKey mixed_key = ~PartKey{0};  ///< the mixture of the cell stands for the part

/// Of the parts of all blocks that grid.fine cuts, which are these, ascending. Throws Cancelled.
[[nodiscard]] std::vector<PartKey> part_keys(const ViewingGrid& grid, const ResinVolume& volume,
                                             std::span<const std::uint32_t> blocks, const Progress* progress);

/// A part full of one material, and one of a solid cell without any.
[[nodiscard]] PartKey whole_key(const ViewingGrid& grid, Material m);
[[nodiscard]] PartKey empty_key(const ViewingGrid& grid);
/// Neither that of air nor of mixed parts.
[[nodiscard]] Mixture mixture_of_key(const ViewingGrid& grid, PartKey key);

}  // namespace voxtone::optics
