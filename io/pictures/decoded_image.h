// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture as its decoder leaves it (io/decoders/decode_image.h).
#pragma once

#include <string>
#include <vector>

#include "io/pictures/texel_image.h"

namespace voxtone::io {

struct DecodedImage {
    TexelImage texels;
    double dpi_x = 0, dpi_y = 0;  ///< 0: not in the file
    double pixel_aspect = 1;      ///< height of a pixel by its width
    bool has_alpha = false;       ///< some pixel is not opaque
    bool is_drawing = false;      ///< it has as many pixels as were asked for; dpi_x tells its own size
    std::vector<std::string> warnings;
    std::string lost_colour;  ///< what the file shows and is not read of it, in a sentence; empty: nothing
};

}  // namespace voxtone::io
