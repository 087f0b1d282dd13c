// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lossy WebP (libwebp): pictures of prints on pages. A halftone is noise to PNG, which takes six to ten times the
// bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/pictures/picture_writer.h"

namespace voxtone::io {

/// The bytes of a WebP file, colour at a quality of 90 of 100, coverage exact; colour without coverage is not kept. At
/// most 16383 px a side. The same picture gives the same bytes.
[[nodiscard]] std::vector<std::uint8_t> webp_bytes(const Picture8& picture);

[[nodiscard]] bool is_webp(std::span<const std::uint8_t> file);

/// RGBA. Throws InputError beginning with `source`.
[[nodiscard]] Picture8 read_webp(std::span<const std::uint8_t> file, const std::string& source);

}  // namespace voxtone::io
