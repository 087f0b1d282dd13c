// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a WebP file says of its pixels, which libwebp's decoder does not hand on: profile, Exif, frames.
// Source: RFC 9649 (the chunks of an extended file).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/decoders/exif.h"

namespace voxtone::io {

/// One picture of an animation, laid on its canvas.
struct WebpFrame {
    std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;
    std::span<const std::uint8_t> chunks{};  ///< its pixels, as those of a file without its head
};

struct WebpFacts {
    std::span<const std::uint8_t> icc_profile{};  ///< in the file's bytes; empty: none
    ExifFacts exif;
    bool is_animation = false;                                ///< says so
    std::uint32_t canvas_width_px = 0, canvas_height_px = 0;  ///< of an extended file; 0: of a plain one
    std::uint32_t frames = 0;
    WebpFrame first{};  ///< of the frames; without chunks where there is none
};

/// Chunks that do not fit in the file say nothing.
[[nodiscard]] WebpFacts webp_facts(std::span<const std::byte> file);

}  // namespace voxtone::io
