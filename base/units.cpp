// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone {

namespace {

constexpr std::array<std::pair<std::string_view, double>, 10> known_units{{{"um", 1e-3},
                                                                           {"mm", 1.0},
                                                                           {"cm", 10.0},
                                                                           {"m", 1000.0},
                                                                           {"in", mm_per_inch},
                                                                           {"ft", 12 * mm_per_inch},
                                                                           {"micron", 1e-3},
                                                                           {"millimeter", 1.0},
                                                                           {"centimeter", 10.0},
                                                                           {"inch", mm_per_inch}}};

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

}  // namespace

std::string with_decimal_point(std::string_view text) {
    const std::size_t comma = text.find(',');
    const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    if (comma == std::string_view::npos || comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1)) return {};
    std::string point(text);
    point[comma] = '.';
    return point;
}

double mm_per_unit(std::string_view unit) {
    for (const auto& [name, mm] : known_units)
        if (name == unit) return mm;
    throw UsageError(fmt::format("unknown unit '{}'; known units are um, mm, cm, m, in, ft", unit));
}

double parse_length_mm(std::string_view text, std::string_view what) {
    const std::string_view whole = trimmed(text);
    double number = 0;
    const auto [rest, status] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
    if (status != std::errc{} || !std::isfinite(number))
        throw UsageError(
            fmt::format("{}: '{}' is not a length; write a number with a unit, such as 60mm or 2.5in", what, text));
    if (const std::string point = with_decimal_point(whole); !point.empty())
        throw UsageError(
            fmt::format("{}: '{}' has a comma, which may part thousands or decimals; write {}", what, text, point));
    const std::string_view unit = trimmed({rest, static_cast<std::size_t>(whole.data() + whole.size() - rest)});
    try {
        return unit.empty() ? number : number * mm_per_unit(unit);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: '{}': {}", what, text, error.what()));
    }
}

}  // namespace voxtone
