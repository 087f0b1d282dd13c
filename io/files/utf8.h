// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace voxtone::io {

/// Appends the code point `c`, below 0x110000, as UTF-8.
void append_utf8(std::string& text, std::uint32_t c);

/// The text of a file as UTF-8 without a byte order mark. UTF-16 of either order, which some programs write where one
/// asks for text, is known by its mark, or by the zeros in its first two characters; halves of surrogates and an odd
/// byte at the end become U+FFFD. Other bytes stay as they are.
[[nodiscard]] std::string text_as_utf8(std::string_view bytes);

}  // namespace voxtone::io
