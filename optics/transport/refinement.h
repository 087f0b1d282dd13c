// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which blocks of a viewing grid are cut finer, and what their parts hold.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/media/resin_volume.h"
#include "voxtone/optics/transport/transport_options.h"
#include "voxtone/optics/transport/viewing_grid.h"

namespace voxtone::optics {

/// Into how many parts a cell of so many voxels is cut along each axis: into voxels, or pieces of voxels where these
/// are longer than `finest_mm` (0: never).
[[nodiscard]] std::array<int, 3> parts_of_cell(const std::array<int, 3>& view_voxels,
                                               const std::array<double, 3>& pitch_mm, double finest_mm);

/// The transport blocks that `refine` would cut, ascending.
[[nodiscard]] std::vector<std::uint32_t> blocks_to_refine(const ViewingGrid& viewing, const ResinVolume& volume,
                                                          Refinement which);

/// Cuts blocks of a grid that was filled with this volume (viewing_palette.h), and fills their parts: those that
/// `which` names (transport_options.h). Where they hold more than `most_contents` different things (at least whole
/// resins and nothing), the rest are taken to be full of one of their resins. Throws Cancelled, with the grid of no use
/// any more.
void refine(ViewingGrid& viewing, const ResinVolume& volume, Refinement which, const std::array<int, 3>& split,
            const Progress* progress = nullptr, std::size_t most_contents = 65536);

}  // namespace voxtone::optics
