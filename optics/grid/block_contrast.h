// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which blocks of a viewing grid are cut finer.
//
// How much the resins of a block differ to the eye: what the error of cells that average them grows with.
//
// A resin looks as a thick body of it reflects diffuse light (H. C. van de Hulst, "Multiple Light Scattering", Academic
// Press 1980, Ch. 11), without its surface:
//
//   A = (1 - s) (1 - 0.139 s) / (1 + 1.17 s),   s = sqrt((1 - albedo) / (1 - g albedo)),
//
// and L = 116 A^(1/3) - 16, 0 at the least, per channel. A block's contrast is the standard deviation of L over what
// its cells hold, by volume, or half of the difference of its mean from that of a neighbour, where that is more; root
// mean square over the channels.
#pragma once

#include <cstdint>
#include <vector>

#include "optics/media/resin_volume.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

struct ViewingGrid;

/// Which blocks of a viewing grid have cells no larger than voxels (refinement.h).
enum class Refinement : std::uint8_t {
    none,
    contrast,  ///< those that light enters, of several resins or at an edge between two: deeper ones are out of sight
    all
};

/// Whether cutting cells would tell voxels apart. Where droplets have run together there are none to be told: parts of
/// one resin each printed flat colours of a J750 2.3 CIEDE2000 off, cells 0.7 (docs/decisions/008).
[[nodiscard]] bool voxels_are_apart(const ResinSet& resins);

/// The transport blocks that are to be cut, by geometry and resins alone, ascending: a body of one resin has none
/// unless `which` is all.
[[nodiscard]] std::vector<std::uint32_t> blocks_to_refine(const ViewingGrid& grid, const ResinVolume& volume,
                                                          Refinement which);

/// L of each resin, [resin * channels + channel].
[[nodiscard]] std::vector<float> lightness_of_resins(const ResinSet& resins);

/// Of each transport block of a grid that was filled (homogenisation.h).
[[nodiscard]] std::vector<float> contrast_of_blocks(const ViewingGrid& grid, const ResinSet& resins);

/// Of those, in a grid that was filled with a volume of these resins (homogenisation.h), the ones whose contrast
/// is `least` or more.
[[nodiscard]] std::vector<std::uint32_t> blocks_of_contrast(const ViewingGrid& grid, const ResinSet& resins,
                                                            std::vector<std::uint32_t> blocks, double least);

}  // namespace voxtone::optics
