// SPDX-License-Identifier: GPL-3.0-or-later
//
// A JPEG of 8 bits (ITU T.81; JFIF, Exif, Adobe): grey, YCbCr, RGB, CMYK and YCCK, sequential and progressive.
//
// Rows are never made up: libjpeg shows grey where codes are missing, so a file that runs out of them is refused. One
// that lacks nothing but its end mark, as some cameras leave them, is read, and said. CMYK goes through its embedded
// profile; without one, red = (1 - c) (1 - k), and so on, which is said.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// Throws InputError where it is damaged or cut short.
[[nodiscard]] DecodedImage decode_jpeg(std::span<const std::byte> bytes, const std::string& name,
                                       const DecodeOptions& options);

}  // namespace voxtone::io
