// SPDX-License-Identifier: GPL-3.0-or-later
//
// A PNG of any kind (W3C PNG 3): grey, palette, RGB, with and without alpha, 1 to 16 bits, interlaced. What its samples
// mean is told, in this order, by cICP, iCCP, sRGB, gAMA with cHRM; where nothing is said they are sRGB codes. Of an
// animation, the picture that viewers without animation show.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// Throws InputError where it is damaged or cut short: rows are never made up. Only its end mark may be missing.
[[nodiscard]] DecodedImage decode_png(std::span<const std::byte> bytes, const std::string& name,
                                      const DecodeOptions& options);

}  // namespace voxtone::io
