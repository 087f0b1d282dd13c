// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a WebP file says of its pixels, which OpenImageIO 2.4 does not hand on.
// Source: RFC 9649 (the chunks of an extended file).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/decoders/exif.h"

namespace voxtone::io {

struct WebpFacts {
    std::span<const std::uint8_t> icc_profile{};  ///< in the file's bytes; empty: none
    ExifFacts exif;
};

/// Chunks that do not fit in the file say nothing.
[[nodiscard]] WebpFacts webp_facts(std::span<const std::byte> file);

}  // namespace voxtone::io
