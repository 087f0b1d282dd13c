// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a sequence of predictions keeps, as bytes for a checkpoint and back: how the body is cut, where grids have
// become deeper, the light of all tiles and what is between them. Some 25 bytes a viewing cell.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "optics/scene/appearance_model.h"
#include "optics/transport/tile_grids.h"

namespace voxtone::optics {

/// phi at the ghosts of all tiles, [channel][ghost]; empty before the first solve.
using GhostLight = std::vector<std::vector<float>>;

void write_state(const TileGrids& grids, const GhostLight& ghosts, const AppearanceSequence::StateSink& sink);
/// False where the bytes are not those of such a sequence; all is of no use then. Drops the tiles' shapes.
[[nodiscard]] bool read_state(TileGrids& grids, GhostLight& ghosts, std::size_t channels,
                              std::span<const std::byte> state);

}  // namespace voxtone::optics
