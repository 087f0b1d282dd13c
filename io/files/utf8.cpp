// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/utf8.h"

namespace voxtone::io {

namespace {

enum class ByteOrder { none, little, big };

ByteOrder utf16_order(std::string_view bytes) {
    if (bytes.starts_with("\xFF\xFE")) return ByteOrder::little;
    if (bytes.starts_with("\xFE\xFF")) return ByteOrder::big;
    if (bytes.size() < 4) return ByteOrder::none;
    const auto zero = [&](std::size_t i) { return bytes[i] == '\0'; };
    if (!zero(0) && zero(1) && !zero(2) && zero(3)) return ByteOrder::little;
    if (zero(0) && !zero(1) && zero(2) && !zero(3)) return ByteOrder::big;
    return ByteOrder::none;
}

std::string utf8_of_utf16(std::string_view bytes, bool little) {
    constexpr std::uint32_t replacement = 0xfffd;
    const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])); };
    const auto unit = [&](std::size_t i) { return little ? byte(i) | byte(i + 1) << 8 : byte(i) << 8 | byte(i + 1); };
    std::string text;
    text.reserve(bytes.size() / 2);
    std::size_t at = 0;
    for (; at + 1 < bytes.size(); at += 2) {
        std::uint32_t c = unit(at);
        if (c >= 0xd800 && c < 0xe000) {
            const std::uint32_t low = at + 3 < bytes.size() ? unit(at + 2) : 0;
            const bool pair = c < 0xdc00 && low >= 0xdc00 && low < 0xe000;
            c = pair ? 0x10000 + ((c - 0xd800) << 10) + (low - 0xdc00) : replacement;
            if (pair) at += 2;
        }
        append_utf8(text, c);
    }
    if (at < bytes.size()) append_utf8(text, replacement);
    return text;
}

}  // namespace

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

std::string text_as_utf8(std::string_view bytes) {
    if (bytes.starts_with("\xEF\xBB\xBF")) return std::string(bytes.substr(3));
    const ByteOrder order = utf16_order(bytes);
    if (order == ByteOrder::none) return std::string(bytes);
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) bytes.remove_prefix(2);
    return utf8_of_utf16(bytes, order == ByteOrder::little);
}

}  // namespace voxtone::io
