// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures for a person to check a reading of photographs by. Of a slab or the sheet: the photograph after the
// correction of light and colours, the squares of the board as they were found (blue), the region that was cut (green)
// with the edge in its middle (yellow), what was left out of it (red). Of the light: how much brighter or darker the
// white paper is than in the middle of the region, in false colours from -5 to +5 %, lines every 1 %.
#pragma once

#include "calibration/bench/bench_light.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::calibration {

struct OverlayOptions {
    double square_mm = 20, width_mm = 10, length_mm = 10;
    int longest_px = 1200;
};

[[nodiscard]] io::Picture8 strip_overlay(const io::Photograph& photograph, const BenchLight& light,
                                         const BoardView& board, const EdgeStrip& strip, const OverlayOptions& options);
[[nodiscard]] io::Picture8 light_overlay(const LightMap& map, const BoardView& board, const OverlayOptions& options);

}  // namespace voxtone::calibration
