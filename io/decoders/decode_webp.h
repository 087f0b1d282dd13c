// SPDX-License-Identifier: GPL-3.0-or-later
//
// WebP, lossy and lossless, with alpha (libwebp). Of an animation the first frame is taken, laid on its canvas.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// Throws InputError naming the picture.
[[nodiscard]] DecodedImage decode_webp(std::span<const std::byte> bytes, const std::string& name,
                                       const DecodeOptions& options);

}  // namespace voxtone::io
