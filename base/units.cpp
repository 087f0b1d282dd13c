// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone {

namespace {

/// What a number may be followed by, and how many of the bare unit that is.
struct Measure {
    std::string_view a_length;  ///< "a length"
    std::string_view example;
    std::string_view known;
    std::span<const std::pair<std::string_view, double>> units;
};

constexpr std::array<std::pair<std::string_view, double>, 10> length_units{{{"um", 1e-3},
                                                                            {"mm", 1.0},
                                                                            {"cm", 10.0},
                                                                            {"m", 1000.0},
                                                                            {"in", mm_per_inch},
                                                                            {"ft", 12 * mm_per_inch},
                                                                            {"micron", 1e-3},
                                                                            {"millimeter", 1.0},
                                                                            {"centimeter", 10.0},
                                                                            {"inch", mm_per_inch}}};
constexpr double gib = 1 << 30;
constexpr std::array<std::pair<std::string_view, double>, 8> memory_units{{{"KiB", 1024 / gib},
                                                                           {"MiB", 1024 * 1024 / gib},
                                                                           {"GiB", 1.0},
                                                                           {"TiB", 1024.0},
                                                                           {"kB", 1e3 / gib},
                                                                           {"MB", 1e6 / gib},
                                                                           {"GB", 1e9 / gib},
                                                                           {"TB", 1e12 / gib}}};
constexpr std::array<std::pair<std::string_view, double>, 4> time_units{
    {{"s", 1.0}, {"min", 60.0}, {"h", 3600.0}, {"d", 86400.0}}};

constexpr Measure length{"a length", "60mm or 2.5in", "um, mm, cm, m, in, ft", length_units};
constexpr Measure memory{"an amount of memory", "2GiB or 1500MB", "KiB, MiB, GiB, TiB, kB, MB, GB, TB", memory_units};
constexpr Measure time_span{"a time", "90s or 2min", "s, min, h, d", time_units};

double in_bare_units(const Measure& measure, std::string_view unit) {
    for (const auto& [name, bare] : measure.units)
        if (name == unit) return bare;
    throw UsageError(fmt::format("unknown unit '{}'; known units are {}", unit, measure.known));
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

double parse_measure(const Measure& measure, std::string_view text, std::string_view what) {
    const std::string_view whole = trimmed(text);
    double number = 0;
    const auto [rest, status] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
    if (status != std::errc{} || !std::isfinite(number))
        throw UsageError(fmt::format("{}: '{}' is not {}; write a number with a unit, such as {}", what, text,
                                     measure.a_length, measure.example));
    if (const std::string point = with_decimal_point(whole); !point.empty())
        throw UsageError(
            fmt::format("{}: '{}' has a comma, which may part thousands or decimals; write {}", what, text, point));
    const std::string_view unit = trimmed({rest, static_cast<std::size_t>(whole.data() + whole.size() - rest)});
    try {
        return unit.empty() ? number : number * in_bare_units(measure, unit);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: '{}': {}", what, text, error.what()));
    }
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

double mm_per_unit(std::string_view unit) { return in_bare_units(length, unit); }

double parse_length_mm(std::string_view text, std::string_view what) { return parse_measure(length, text, what); }
double parse_memory_gib(std::string_view text, std::string_view what) { return parse_measure(memory, text, what); }
double parse_time_s(std::string_view text, std::string_view what) { return parse_measure(time_span, text, what); }

}  // namespace voxtone
