// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bitmaps for RIPs other than the Voxel Print utility: one 1-bit bitmap per resin and layer (PNG, or TIFF in CCITT
// Group 4), or one indexed 8-bit PNG per layer whose values are materials. The same layer gives the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "io/layers/layer_runs.h"
#include "io/layers/rgb.h"

namespace voxtone::io {

enum class ResinBitmaps { none, png1, png8, tiff1 };

/// 1-bit grey PNG: white (1) where the layer has this material.
[[nodiscard]] std::vector<std::uint8_t> encode_png1(const LayerRuns& layer, Material material,
                                                    std::array<double, 2> pitch_um);
/// Indexed 8-bit PNG: the value is the material, the colours are the palette's.
[[nodiscard]] std::vector<std::uint8_t> encode_png8(const LayerRuns& layer, std::span<const Rgb> palette,
                                                    std::array<double, 2> pitch_um);
/// 1-bit TIFF, Group 4, min-is-white: 1 (black) where the layer has this material.
[[nodiscard]] std::vector<std::uint8_t> encode_tiff1(const LayerRuns& layer, Material material,
                                                     std::array<double, 2> pitch_um);

}  // namespace voxtone::io
