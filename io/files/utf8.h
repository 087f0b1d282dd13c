// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace voxtone::io {

/// Appends the code point `c`, below 0x110000, as UTF-8.
void append_utf8(std::string& text, std::uint32_t c);

}  // namespace voxtone::io
