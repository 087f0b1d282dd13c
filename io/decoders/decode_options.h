// SPDX-License-Identifier: GPL-3.0-or-later
//
// What decoding a picture may take, and how its file is understood.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <type_traits>

#include "io/files/read_options.h"
#include "io/pictures/decoded_image.h"

namespace voxtone::io {

struct DecodeOptions;

/// Decodes pictures of kinds other than PNG, JPEG and WebP: bytes, the kind (io/decoders/decode_image.h), a name for
/// messages. Throws InputError.
using OtherDecoder = std::function<DecodedImage(std::span<const std::byte> bytes, const std::string& format,
                                                const std::string& name, const DecodeOptions& options)>;

struct DecodeOptions {
    std::uint64_t max_pixels = std::uint64_t{1} << 28;  ///< more are refused; in [1, 2^32]
    bool use_profile = true;    ///< false: samples are sRGB whatever the file says (glTF demands it)
    bool turn_upright = false;  ///< apply the EXIF orientation (photographs; textures are laid down as stored)
    OtherDecoder others = {};   ///< empty: other kinds are refused
    DrawingRaster drawing = {};
};

}  // namespace voxtone::io
