// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/tables/table_cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "base/printable.h"

namespace voxtone::calibration {

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return text;
}

std::vector<std::string_view> split(std::string_view line, char at) {
    std::vector<std::string_view> cells;
    for (std::size_t from = 0;;) {
        const std::size_t to = line.find(at, from);
        cells.push_back(trimmed(line.substr(from, to - from)));
        if (to == std::string_view::npos) return cells;
        from = to + 1;
    }
}

std::vector<std::string_view> split_quoted(std::string_view line, char at) {
    std::vector<std::string_view> cells;
    bool quoted = false;
    std::size_t from = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i < line.size() && line[i] == '"') quoted = !quoted;
        if (i < line.size() && (quoted || line[i] != at)) continue;
        cells.push_back(trimmed(line.substr(from, i - from)));
        from = i + 1;
    }
    return cells;
}

std::optional<double> number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<double> number_with_comma(std::string_view text) {
    constexpr std::size_t longest = 60;
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos || text.size() > longest) return number(text);
    if (text.find_first_of(",.", comma + 1) != std::string_view::npos) return std::nullopt;
    std::string with_point(text);
    with_point[comma] = '.';
    return number(with_point);
}

std::string shown(std::string_view text) {
    return fmt::format("\"{}{}\"", printable(text.substr(0, 40)), text.size() > 40 ? "..." : "");
}

std::string shown_list(const std::vector<std::string>& texts) {
    constexpr std::size_t most_shown = 8;
    std::string list;
    for (std::size_t k = 0; k < std::min(texts.size(), most_shown); ++k)
        list += fmt::format("{}{}", k == 0 ? "" : ", ", shown(texts[k]));
    if (texts.size() > most_shown) list += fmt::format(" and {} more", texts.size() - most_shown);
    return list;
}

std::string in_capitals(std::string_view text) {
    std::string capitals(text);
    std::ranges::transform(capitals, capitals.begin(),
                           [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    return capitals;
}

bool is_role(std::string_view text) {
    constexpr std::size_t most_bytes_of_role = 32;
    return !text.empty() && text.size() <= most_bytes_of_role &&
           text.find_first_of(":+%,\"\n\t") == std::string_view::npos && printable(text) == text;
}

std::string comment_lines(std::string_view text) {
    std::string lines;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find('\n', from), text.size());
        lines += fmt::format("# {}\n", text.substr(from, to - from));
        from = to + 1;
    }
    return lines;
}

}  // namespace voxtone::calibration
