// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts a body into the blocks, cells and faces of a ViewingGrid (viewing_grid.h says by which rules).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "optics/grid/block_choice.h"
#include "optics/grid/viewing_grid.h"
#include "optics/scene/scene.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

/// With the contents of the scene's volume. `also`: blocks of the window that get transport cells besides, empty or one
/// byte per place. `requested`: the surface below which colour is expected to come and go, null: all of it. Throws
/// InputError for a material without a resin, Cancelled.
[[nodiscard]] ViewingGrid make_viewing_grid(const Scene& scene, const std::array<int, 3>& view_voxels,
                                            const ColourDepth& colour, std::span<const std::uint8_t> also,
                                            const ViewingWindow& window, const Surface* requested = nullptr,
                                            const Progress* progress = nullptr);

/// The same without contents: what cells and nodes hold is not known before `homogenise` (homogenisation.h).
[[nodiscard]] ViewingGrid make_empty_viewing_grid(const Scene& scene, const std::array<int, 3>& view_voxels,
                                                  const ColourDepth& colour, std::span<const std::uint8_t> also,
                                                  const ViewingWindow& window, const Surface* requested = nullptr,
                                                  const Progress* progress = nullptr);

}  // namespace voxtone::optics
