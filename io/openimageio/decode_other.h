// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of all kinds but PNG, JPEG and WebP, by OpenImageIO: TIFF, BMP, TGA, GIF, OpenEXR, Radiance HDR, PNM, PSD.
//
// TIFF of Lab colours (CIELAB, ICCLab; D50 unless the file says another white, adapted to D65) and of inks (CMYK, with
// further channels left aside), and Photoshop's CMYK, are taken as they are stored and converted here. Of files with
// several pictures the first is taken that is not marked as a smaller copy, and it is said how many there are; of an
// OpenEXR's layers one (colour_layer.h). A Photoshop file of layers without a picture of all of them is lost colour.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// `format` as OpenImageIO names it (io/decoders/decode_image.h). Throws InputError.
[[nodiscard]] DecodedImage decode_other(std::span<const std::byte> bytes, const std::string& format,
                                        const std::string& name, const DecodeOptions& options);

}  // namespace voxtone::io
