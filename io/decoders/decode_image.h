// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes of a picture file to pixels. Its kind is told by its first bytes and not by its name (TGA, which has no mark,
// by its name). PNG, JPEG and WebP are decoded here; other kinds (TIFF, BMP, TGA, GIF, OpenEXR, Radiance HDR, PNM, PSD)
// by who is given for them: io/openimageio, which loads a hundred libraries, in a program of its own, and for SVG
// io/drawings in another.
//
// Integer samples are sRGB codes and float samples linear light, unless the file says otherwise; an embedded ICC
// profile is converted to sRGB (relative colorimetric), primaries and curves that are said by numbers are, too. Values
// beyond 1 (float pictures) are clamped, with a warning. Declared sizes are checked before anything is decoded.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// `name` is for messages (and tells TGA). Throws InputError saying what is wrong with the picture.
[[nodiscard]] DecodedImage decode_image(std::span<const std::byte> bytes, const std::string& name,
                                        const DecodeOptions& options = {});

/// The kind that the bytes begin like, as OpenImageIO names it ("png", "jpeg", "tiff", ...), or "svg"; empty: none that
/// is known.
[[nodiscard]] std::string picture_format(std::span<const std::byte> bytes, const std::string& name);

}  // namespace voxtone::io
