// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes of a picture file to pixels: PNG, JPEG, TIFF, BMP, TGA, GIF, WebP, OpenEXR, Radiance HDR and PNM, told apart by
// their first bytes and not by their name (TGA, which has no mark, by its name).
//
// Integer samples are sRGB codes and float samples linear light, unless the file says otherwise; an embedded ICC
// profile of an RGB picture is converted to sRGB (relative colorimetric). Values beyond 1 (float pictures) are clamped,
// with a warning. Declared sizes are checked before anything is decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "voxtone/io/pictures/decoded_image.h"

namespace voxtone::io {

struct DecodeOptions {
    std::uint64_t max_pixels = std::uint64_t{1} << 28;  ///< more are refused; in [1, 2^32]
    bool use_profile = true;    ///< false: samples are sRGB whatever the file says (glTF demands it)
    bool turn_upright = false;  ///< apply the EXIF orientation (photographs; textures are laid down as stored)
};

/// `name` is for messages (and tells TGA). Throws InputError saying what is wrong with the picture.
[[nodiscard]] DecodedImage decode_image(std::span<const std::byte> bytes, const std::string& name,
                                        const DecodeOptions& options = {});

/// Whether the bytes begin like a picture that `decode_image` knows ("PNG", "JPEG", ...); empty: no.
[[nodiscard]] std::string picture_format(std::span<const std::byte> bytes, const std::string& name);

}  // namespace voxtone::io
