// SPDX-License-Identifier: GPL-3.0-or-later
//
// A layer as a complete PNG file: 8-bit RGBA (colour type 6), alpha 255, pHYs with the pixel size per axis, no filter.
//
// The compressed stream (zlib, RFC 1950/1951) is written from the runs: nothing of 4 bytes a pixel is ever laid out.
// One dynamic block per layer with code lengths from the layer's own counts; Adler-32 in closed form per run. The same
// layer gives the same bytes on every machine and for any number of threads.
//
// Why not libpng: it wants every pixel. A layer of 3310 x 1772 px takes 7.8 ms here and 190 ms there (level 6), at
// equal size (docs/decisions/019); libdeflate compresses bytes too. run_matcher and huffman_code are its two halves.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "io/layers/layer_runs.h"
#include "io/layers/rgb.h"

namespace voxtone::io {

/// Pixels per metre along columns and rows as PNG's pHYs chunk holds them: 1e6 / pitch_um, to the nearest.
[[nodiscard]] std::array<std::uint32_t, 2> pixels_per_metre(std::array<double, 2> pitch_um);

/// Adler-32 (RFC 1950) of the bitmap that `layer` means: per row a 0 and R, G, B, 255 of each pixel.
[[nodiscard]] std::uint32_t adler32_of_layer(const LayerRuns& layer, std::span<const Rgb> palette);

class PngLayerEncoder {
public:
    /// palette[m] is the colour of material m; palette[0] the background's. At most `max_materials`, pitch_um > 0.
    PngLayerEncoder(std::vector<Rgb> palette, std::array<double, 2> pitch_um);

    /// The bytes of the file. The layer's rows are complete and its materials are in the palette.
    /// May be called from any thread.
    [[nodiscard]] std::vector<std::uint8_t> encode(const LayerRuns& layer) const;

    [[nodiscard]] const std::vector<Rgb>& palette() const { return palette_; }

private:
    std::vector<Rgb> palette_;
    std::array<std::uint32_t, 2> pixels_per_metre_;
};

}  // namespace voxtone::io
