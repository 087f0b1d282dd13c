// SPDX-License-Identifier: GPL-3.0-or-later
//
// The few facts of a photograph's Exif block (CIPA DC-008) that its pixels need.
#pragma once

#include <cstdint>
#include <span>

namespace voxtone::io {

struct ExifFacts {
    int orientation = 1;          ///< how the picture is to be turned, 1 to 8 (tag 0x0112)
    double dpi_x = 0, dpi_y = 0;  ///< 0: not in the block
};

/// Of its first directory. The block begins with its byte order ("II" or "MM"); what is damaged says nothing.
[[nodiscard]] ExifFacts exif_facts(std::span<const std::uint8_t> exif);

}  // namespace voxtone::io
