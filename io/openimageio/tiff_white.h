// SPDX-License-Identifier: GPL-3.0-or-later
//
// The white that colours of a TIFF are relative to (tag 318), which OpenImageIO does not tell.
// Source: TIFF 6.0, section 20; BigTIFF.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace voxtone::io {

/// CIE x and y, of the page with this index; nothing where the page does not say it, or says what is no colour.
[[nodiscard]] std::optional<std::array<double, 2>> tiff_white(std::span<const std::byte> file, int page);

}  // namespace voxtone::io
