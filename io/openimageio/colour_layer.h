// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which channels of a many-layered picture (OpenEXR) are its colours.
//
// A channel's name is LAYER.KIND, as OpenEXR's convention has it ("ViewLayer.Combined.R"); the layer may have no name.
// Red, green, blue and alpha are taken of one layer and never of two: of the one without a name, else of that which is
// called Combined, else of the first that has red, green and blue, else of the first with a luminance, Y. A single
// channel of any name is grey.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace voxtone::io {

struct ColourLayer {
    std::string name{};  ///< empty: the one without a name
    /// Indices of red, green, blue and alpha; the same one three times for grey; -1: opaque.
    std::array<int, 4> channels{0, 0, 0, -1};
    int rank = 0;  ///< the less, the more likely to be what is meant
};

/// `part`: name of the part that has the channels, which stands for a layer's where they have none; of files of several
/// parts. Nothing where no layer has colours.
[[nodiscard]] std::optional<ColourLayer> find_colour_layer(const std::vector<std::string>& channels,
                                                           const std::string& part = {});

/// Names of all layers, in their order; that without a name is empty.
[[nodiscard]] std::vector<std::string> layer_names(const std::vector<std::string>& channels);

}  // namespace voxtone::io
