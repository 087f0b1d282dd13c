// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/utf8.h"

namespace voxtone::io {

void append_utf8(std::string& text, std::uint32_t c) {
    const auto more = [&](int shift) { text += static_cast<char>(0x80 | (c >> shift & 0x3f)); };
    if (c < 0x80) {
        text += static_cast<char>(c);
    } else if (c < 0x800) {
        text += static_cast<char>(0xc0 | c >> 6);
        more(0);
    } else if (c < 0x10000) {
        text += static_cast<char>(0xe0 | c >> 12);
        more(6), more(0);
    } else {
        text += static_cast<char>(0xf0 | c >> 18);
        more(12), more(6), more(0);
    }
}

}  // namespace voxtone::io
