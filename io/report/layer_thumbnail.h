// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small picture of a layer, true to its proportions although printer pixels are not square.
//
// A pixel of the picture is a square of side max(width_mm, height_mm) / longest_px; its colour is the mean of what it
// covers, by exact area, in linear light; coverage is the share of its area that is printed.
#pragma once

#include <array>
#include <span>

#include "io/layers/layer_runs.h"
#include "io/layers/rgb.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::io {

/// palette[m] is the colour of material m; palette[0], the background's, is not looked at. The layer's rows are
/// complete. The longer side has `longest_px` pixels; the shorter is rounded up, and what sticks out of the layer is
/// not covered.
[[nodiscard]] LinearPicture layer_thumbnail(const LayerRuns& layer, std::span<const Rgb> palette,
                                            const std::array<double, 2>& pitch_mm, std::uint32_t longest_px);

}  // namespace voxtone::io
