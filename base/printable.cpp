// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/printable.h"

#include <cstddef>

#include <fmt/core.h>

namespace voxtone {

namespace {

/// Bytes of the well-formed sequence at the start of `text` (Unicode 15, Table 3-7), or 0.
std::size_t sequence_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto continues = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
    const unsigned lead = byte(0), second = byte(1);
    if (lead < 0x80) return 1;
    if (lead >= 0xC2 && lead <= 0xDF) return continues(1) ? 2 : 0;
    if (lead >= 0xE0 && lead <= 0xEF) {
        const bool second_fits = continues(1) && !(lead == 0xE0 && second < 0xA0) && !(lead == 0xED && second > 0x9F);
        return second_fits && continues(2) ? 3 : 0;
    }
    if (lead >= 0xF0 && lead <= 0xF4) {
        const bool second_fits = continues(1) && !(lead == 0xF0 && second < 0x90) && !(lead == 0xF4 && second > 0x8F);
        return second_fits && continues(2) && continues(3) ? 4 : 0;
    }
    return 0;
}

/// Characters that stand for one byte, 0x80 to 0xFF: U+EF80 to U+EFFF, which are EE BE 80 to EE BF BF.
std::string stand_in(unsigned char byte) {
    return {'\xEE', static_cast<char>(byte < 0xC0 ? 0xBE : 0xBF), static_cast<char>(0x80 | (byte & 0x3F))};
}

/// The byte that the well-formed sequence at the start of `text` stands for; -1: it stands for itself.
int byte_stood_for(std::string_view text) {
    if (text.size() < 3 || text[0] != '\xEE' || (text[1] != '\xBE' && text[1] != '\xBF')) return -1;
    return (text[1] == '\xBE' ? 0x80 : 0xC0) | (static_cast<unsigned char>(text[2]) & 0x3F);
}

}  // namespace

std::string valid_utf8(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = sequence_length(text.substr(i));
        if (length == 0)
            result += "\xEF\xBF\xBD";
        else
            result += text.substr(i, length);
        i += length == 0 ? 1 : length;
    }
    return result;
}

std::string printable(std::string_view text) {
    std::string result;
    const std::string valid = valid_utf8(text);
    for (std::size_t i = 0; i < valid.size(); ++i) {
        const auto c = static_cast<unsigned char>(valid[i]);
        const bool c1 = c == 0xC2 && static_cast<unsigned char>(valid[i + 1]) < 0xA0;
        if (c1) ++i;
        if (c1 || (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F)
            result += '?';
        else
            result += valid[i];
    }
    return result;
}

std::string escaped_bytes(std::string_view bytes) {
    std::string result;
    result.reserve(bytes.size());
    for (std::size_t i = 0; i < bytes.size();) {
        const std::string_view rest = bytes.substr(i);
        const std::size_t length = sequence_length(rest);
        if (length == 0 || byte_stood_for(rest.substr(0, length)) >= 0) {
            result += stand_in(static_cast<unsigned char>(bytes[i++]));
            continue;
        }
        result += rest.substr(0, length);
        i += length;
    }
    return result;
}

std::string unescaped_bytes(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        const int byte = byte_stood_for(text.substr(i));
        result += byte < 0 ? text[i] : static_cast<char>(byte);
        i += byte < 0 ? 1 : 3;
    }
    return result;
}

std::string json_quoted(std::string_view text) {
    std::string result = "\"";
    for (const char c : escaped_bytes(text)) {
        switch (c) {
            case '"':
                result += "\\\"";
                break;
            case '\\':
                result += "\\\\";
                break;
            case '\n':
                result += "\\n";
                break;
            case '\t':
                result += "\\t";
                break;
            default:
                if (static_cast<unsigned char>(c) < 0x20)
                    result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
                else
                    result += c;
        }
    }
    return result + '"';
}

}  // namespace voxtone
