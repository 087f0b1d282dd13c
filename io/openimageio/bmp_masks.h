// SPDX-License-Identifier: GPL-3.0-or-later
//
// A BMP of 32 bits may say by masks (BI_BITFIELDS) which byte of a pixel is which colour. OpenImageIO 2.4 leaves them
// aside and takes blue, green, red, alpha.
// Source: Microsoft's BITMAPV4HEADER.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace voxtone::io {

/// `rgba`: as OpenImageIO has it, of the file's bytes; put in the order of its masks, opaque where none is of alpha.
/// Without masks the fourth byte is alpha, or nothing: zero everywhere.
/// Throws InputError where masks are not one byte each.
void apply_bmp_masks(std::span<std::uint8_t> rgba, std::span<const std::byte> file, const std::string& name);

}  // namespace voxtone::io
