// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which blocks of a viewing grid are cut finer, and what their parts hold.
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

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/media/resin_volume.h"
#include "optics/media/resins.h"
#include "optics/transport/transport_options.h"
#include "optics/transport/viewing_grid.h"

namespace voxtone::optics {

/// Longer voxels are cut along their axis: a J750's along y, into two that are as long as along x. With whole ones the
/// suite's mean was 0.67 for 0.50 (docs/decisions/008).
inline constexpr double finest_part_mm = 0.0425;

/// Into how many parts a cell of so many voxels is cut along each axis: into voxels, or pieces of voxels where these
/// are longer than `finest_part_mm`.
[[nodiscard]] std::array<int, 3> parts_of_cell(const std::array<int, 3>& view_voxels,
                                               const std::array<double, 3>& pitch_mm);

/// Whether cutting cells would tell voxels apart. Where droplets have run together there are none to be told: parts of
/// one resin each printed flat colours of a J750 2.3 CIEDE2000 off, cells 0.7 (docs/decisions/008).
[[nodiscard]] inline bool voxels_are_apart(const ResinSet& resins) { return resins.dot_spread <= 0.5; }

/// The transport blocks that are to be cut, by geometry and resins alone, ascending: a body of one resin has none
/// unless `which` is all.
[[nodiscard]] std::vector<std::uint32_t> blocks_to_refine(const ViewingGrid& grid, const ResinVolume& volume,
                                                          Refinement which);

/// L of each resin, [resin * channels + channel].
[[nodiscard]] std::vector<float> lightness_of_resins(const ResinSet& resins);

/// Of each transport block of a grid that was filled (viewing_palette.h).
[[nodiscard]] std::vector<float> contrast_of_blocks(const ViewingGrid& grid, const ResinSet& resins);

/// Of those, in a grid that was filled with a volume of these resins (viewing_palette.h), the ones whose contrast
/// is `least` or more.
[[nodiscard]] std::vector<std::uint32_t> blocks_of_contrast(const ViewingGrid& grid, const ResinSet& resins,
                                                            std::vector<std::uint32_t> blocks, double least);

/// Cuts these blocks, ascending, of a grid that was filled with this volume (viewing_palette.h), and fills their parts.
/// Where they hold more than `most_contents` different things (at least whole resins and nothing), the rest are taken
/// to be full of one of their resins. Throws Cancelled, with the grid of no use any more.
void refine(ViewingGrid& grid, const ResinVolume& volume, std::span<const std::uint32_t> blocks,
            const std::array<int, 3>& split, const Progress* progress = nullptr, std::size_t most_contents = 65536);

}  // namespace voxtone::optics
