// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/model_text.h"

#include <algorithm>
#include <charconv>
#include <cstdint>

#include "io/files/utf8.h"

namespace voxtone::io {

namespace {

constexpr std::string_view blanks = " \t\r\n\v\f";

std::string from_utf16(std::string_view bytes, bool big) {
    std::string text;
    const auto unit = [&](std::size_t i) {
        const auto a = static_cast<std::uint8_t>(bytes[i]), b = static_cast<std::uint8_t>(bytes[i + 1]);
        return static_cast<std::uint32_t>(big ? a << 8 | b : b << 8 | a);
    };
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        std::uint32_t c = unit(i);
        if (c >= 0xd800 && c < 0xdc00 && i + 3 < bytes.size()) {
            const std::uint32_t low = unit(i + 2);
            if (low >= 0xdc00 && low < 0xe000) {
                c = 0x10000 + ((c - 0xd800) << 10) + (low - 0xdc00);
                i += 2;
            }
        }
        append_utf8(text, c >= 0xd800 && c < 0xe000 ? 0xfffd : c);
    }
    return text;
}

std::string from_utf32(std::string_view bytes, bool big) {
    std::string text;
    for (std::size_t i = 0; i + 3 < bytes.size(); i += 4) {
        std::uint32_t c = 0;
        for (std::size_t b = 0; b < 4; ++b)
            c |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[i + b])) << 8 * (big ? 3 - b : b);
        append_utf8(text, c < 0x110000 && !(c >= 0xd800 && c < 0xe000) ? c : 0xfffd);
    }
    return text;
}

/// Zeros at even and at odd places of the beginning, of `looked_at` bytes.
std::pair<std::size_t, std::size_t> zeros(std::string_view bytes, std::size_t looked_at) {
    std::pair<std::size_t, std::size_t> found{0, 0};
    for (std::size_t i = 0; i < looked_at; ++i)
        if (bytes[i] == 0) ++(i % 2 ? found.second : found.first);
    return found;
}

}  // namespace

std::string model_text(std::span<const std::byte> bytes) {
    const std::string_view raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (raw.starts_with("\xEF\xBB\xBF")) return std::string(raw.substr(3));
    using namespace std::string_view_literals;
    if (raw.starts_with("\xFF\xFE\0\0"sv)) return from_utf32(raw.substr(4), false);
    if (raw.starts_with("\0\0\xFE\xFF"sv)) return from_utf32(raw.substr(4), true);
    if (raw.starts_with("\xFF\xFE")) return from_utf16(raw.substr(2), false);
    if (raw.starts_with("\xFE\xFF")) return from_utf16(raw.substr(2), true);
    const std::size_t looked_at = std::min<std::size_t>(raw.size(), 64) / 2 * 2;
    const auto [even, odd] = zeros(raw, looked_at);
    if (looked_at >= 8 && std::max(even, odd) >= looked_at * 3 / 8 && std::min(even, odd) == 0)
        return from_utf16(raw, even > odd);
    return std::string(raw);
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string lower_case(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

std::optional<std::string_view> TextLines::next() {
    const auto cut = [this] {
        const std::size_t end = std::min(left_.find_first_of("\r\n"), left_.size());
        const std::string_view line = left_.substr(0, end);
        const bool crlf = end + 1 < left_.size() && left_[end] == '\r' && left_[end + 1] == '\n';
        left_.remove_prefix(std::min(left_.size(), end + (crlf ? 2 : 1)));
        ++lines_;
        return trimmed(line);
    };
    while (!left_.empty()) {
        std::string_view line = cut();
        number_ = lines_;
        if (line.empty()) continue;
        if (!joins_ || line.back() != '\\' || line.front() == '#') return line;
        joined_.clear();
        while (!line.empty() && line.back() == '\\') {
            joined_ += trimmed(line.substr(0, line.size() - 1));
            joined_ += ' ';
            if (left_.empty()) break;
            line = cut();
            if (line.empty() || line.back() != '\\') joined_ += line;
        }
        if (const std::string_view whole = trimmed(joined_); !whole.empty()) return whole;
    }
    return std::nullopt;
}

std::string_view cut_word(std::string_view& text) {
    text = trimmed(text);
    const std::size_t end = std::min(text.find_first_of(blanks), text.size());
    const std::string_view word = text.substr(0, end);
    text = trimmed(text.substr(end));
    return word;
}

std::optional<double> number_of(std::string_view word, bool& comma) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto read = [](std::string_view digits) -> std::optional<double> {
        double value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
        return value;
    };
    if (const auto value = read(word)) return value;
    constexpr std::size_t longest = 40;
    const std::size_t at = word.find(',');
    if (at == std::string_view::npos || at != word.rfind(',') || word.size() > longest) return std::nullopt;
    std::string point(word);
    point[at] = '.';
    const auto value = read(point);
    comma = comma || value.has_value();
    return value;
}

}  // namespace voxtone::io
