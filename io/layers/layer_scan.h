// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is in the bitmap of one layer: its colours, and the layer as runs where all of them are known. The bitmap is
// decoded in this process.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/layers/layer_runs.h"
#include "io/layers/rgb.h"
#include "io/pictures/png_pixels.h"

namespace voxtone::io {

using Rgba = std::array<std::uint8_t, 4>;

/// A colour of a layer, how many pixels have it and where the first one is.
struct ColourCount {
    Rgba rgba{};
    std::uint64_t pixels = 0;
    std::uint32_t first_x = 0, first_y = 0;
};

/// What is in one layer's bitmap.
struct LayerScan {
    PngHeader header;
    /// In order of appearance, at most `most_colours`; what has another colour is in `other_pixels`.
    std::vector<ColourCount> colours;
    std::uint64_t other_pixels = 0;
    /// The layer in materials of the palette; absent where a pixel has none of its colours or an alpha other than 255,
    /// unless `OtherPixels` say what that stands for.
    std::optional<LayerRuns> runs;

    static constexpr std::size_t most_colours = 256;
};

/// What pixels stand for that have none of the palette's colours.
struct OtherPixels {
    static constexpr Material unknown = 255;
    Material transparent = unknown;  ///< of alpha 0, whatever their colour
    /// Others are what the nearest colour of the palette is, of blends of two that which they have more of (sRGB
    /// codes); transparent where alpha is below 128.
    bool nearest = false;
};

/// Decodes one layer. With an empty palette there are no runs. Throws InputError beginning with `source`.
[[nodiscard]] LayerScan scan_layer(std::span<const std::uint8_t> file, const std::string& source,
                                   std::span<const Rgb> palette, const OtherPixels& others = {});

}  // namespace voxtone::io
