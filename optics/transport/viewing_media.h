// SPDX-License-Identifier: GPL-3.0-or-later
//
// The media of a viewing grid in one channel: those of the halftone (effective_medium.h) of each cell's voxels, where
// in the cell they lie (seen_medium.h), with the albedo that makes half-spaces exact (transport_medium.h).
#pragma once

#include <cstddef>

#include "optics/media/effective_medium.h"
#include "optics/transport/viewing_transport.h"

namespace voxtone::optics {

/// Of a grid that was filled (viewing_palette.h).
[[nodiscard]] ViewingTransport::Media media_of_grid(const ViewingGrid& grid, const EffectiveMedium& halftone,
                                                    const ResinSet& resins, std::size_t channel);

/// Of its cells, as media_of_grid has them.
[[nodiscard]] std::shared_ptr<const TransportMedia> media_of_cells(const ViewingGrid& grid);

}  // namespace voxtone::optics
