// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a picture's alpha passes through a half: closed outlines by marching squares over the middles of its pixels
// (W. Lorensen, H. Cline, "Marching cubes", SIGGRAPH 1987, in the plane), alpha linear between them and 0 beyond the
// picture's edge, so that an opaque picture's outline is that edge, with corners cut by half a pixel. Where two opaque
// pixels touch at a corner alone, their mean decides whether they are one piece. Corners on a straight line are left
// out. Outlines neither cross nor touch: a crossing keeps a fiftieth of a pixel from the pixels' middles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slicer/mesh/outline_triangles.h"

namespace voxtone::slicer {

/// In pixels from the upper left corner, y downwards. `alpha`: rows from the top, width_px * height_px, 65535 is
/// opaque. `step_px`: means of so many pixels each way stand for one, for pictures finer than any print.
[[nodiscard]] std::vector<Outline> picture_outlines(std::span<const std::uint16_t> alpha, std::uint32_t width_px,
                                                    std::uint32_t height_px, std::uint32_t step_px = 1);

}  // namespace voxtone::slicer
