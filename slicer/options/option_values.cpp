// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_values.h"

#include <algorithm>
#include <charconv>
#include <numbers>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/units.h"
#include "io/files/csv_table.h"
#include "io/models/model_reader.h"
#include "optics/colour/colour.h"
#include "slicer/options/option_words.h"

namespace voxtone::slicer {

namespace {

/// "#rrggbb" in linear light.
std::optional<std::array<double, 3>> colour_in(const std::string& words) {
    if (words.size() != 7 || words[0] != '#') return std::nullopt;
    std::array<double, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
        const char* const first = words.data() + 1 + 2 * c;
        unsigned value = 0;
        const auto [end, error] = std::from_chars(first, first + 2, value, 16);
        if (error != std::errc() || end != first + 2) return std::nullopt;
        rgb[c] = optics::srgb_decode(value / 255.0);
    }
    return rgb;
}

/// Multiples of 90 degrees come out exact, so that an upright box stays upright to the last bit.
Eigen::Matrix3d axis_rotation(int axis, double degrees) {
    const double radians = degrees * std::numbers::pi / 180;
    double c = std::cos(radians), s = std::sin(radians);
    if (std::fmod(degrees, 90.0) == 0) c = std::round(c), s = std::round(s);
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    matrix(u, u) = c, matrix(u, v) = -s, matrix(v, u) = s, matrix(v, v) = c;
    return matrix;
}

}  // namespace

ModelKind model_kind(const std::string& model) {
    if (io::is_model_name(model)) return ModelKind::mesh;
    const bool is_plan = io::extension_of(model) == "json" || io::is_table_file(model, "model");
    return is_plan ? ModelKind::tray_plan : ModelKind::picture;
}

void refuse_choice(std::string_view key, std::string_view text, const std::vector<std::string>& choices) {
    throw UsageError(fmt::format("--{}: '{}' is none of {}", key, text, fmt::join(choices, ", ")));
}

void refuse_number(std::string_view key, std::string_view text) {
    const std::string point = with_decimal_point(text);
    throw UsageError(fmt::format("--{}: '{}' is not a number{}", key, text,
                                 point.empty() ? "" : "; decimals stand behind a point: " + point));
}

bool parse_flag(std::string_view key, std::string_view text) {
    if (text == "true" || text == "on" || text == "yes" || text == "1") return true;
    if (text == "false" || text == "off" || text == "no" || text == "0") return false;
    throw UsageError(fmt::format("--{}: '{}' is neither true nor false", key, text));
}

std::vector<std::string> parse_list(const std::string& text) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        if (end > begin) parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

std::optional<FileUnit> parse_file_unit(const std::string& text) {
    if (text == "auto") return std::nullopt;
    try {
        return FileUnit{text, mm_per_unit(text)};
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("--unit: {}", error.what()));
    }
}

Eigen::Matrix3d parse_rotation(const std::string& text) {
    Eigen::Matrix3d whole = Eigen::Matrix3d::Identity();
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const int axis = text[begin] == 'x' ? 0 : text[begin] == 'y' ? 1 : text[begin] == 'z' ? 2 : -1;
        double degrees = 0;
        const auto [rest, status] = std::from_chars(text.data() + begin + 1, text.data() + end, degrees);
        if (axis < 0 || status != std::errc{} || rest != text.data() + end || !std::isfinite(degrees))
            throw UsageError(
                fmt::format("--rotate: '{}' is no rotation; write an axis and degrees, such as x90 or z45,x-30", text));
        whole = axis_rotation(axis, degrees) * whole;
        begin = end + 1;
    }
    return whole;
}

std::optional<int> parse_count_or_auto(std::string_view key, const std::string& text, int most,
                                       std::string_view or_else) {
    if (text == "auto") return std::nullopt;
    const int n = parse_number<int>(key, text);
    if (n < 0 || n > most) throw UsageError(fmt::format("--{} {}: must be 0 to {}, {}", key, text, most, or_else));
    return n;
}

std::optional<int> parse_iterations(const std::string& text) {
    return text == patient_word ? std::nullopt : parse_count_or_auto("iterations", text, 1000, "auto or long");
}

std::optional<LayerRange> parse_layer_range(const std::string& text) {
    if (text.empty()) return std::nullopt;
    const std::size_t dash = text.find('-');
    LayerRange range;
    range.first = parse_number<int>("layers", text.substr(0, dash));
    range.last = dash == std::string::npos ? range.first : parse_number<int>("layers", text.substr(dash + 1));
    if (range.first < 0 || range.last < range.first)
        throw UsageError(fmt::format("--layers: '{}' is no range; write first-last, such as 0-99", text));
    return range;
}

std::optional<io::ShardNumber> parse_shard(const std::string& text) {
    if (text.empty() || text == "auto") return std::nullopt;
    const std::size_t slash = text.find('/');
    const auto number = [](std::string_view digits) {
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return error == std::errc() && end == digits.data() + digits.size() ? value : 0;
    };
    io::ShardNumber shard{0, 0};
    if (slash != std::string::npos) shard = {number(text.substr(0, slash)), number(text.substr(slash + 1))};
    if (shard.shard < 1 || shard.shard > shard.of || shard.of > io::ShardNumber::most)
        throw UsageError(
            fmt::format("--shard: '{}' is no part of the layers; write which of how many, from 1, such as "
                        "3/16 (at most {}), or auto",
                        text, io::ShardNumber::most));
    return shard;
}

LayerRange range_within(const std::optional<LayerRange>& asked, int layers) {
    if (!asked) return {0, layers - 1};
    if (asked->first >= layers)
        throw InputError(fmt::format(
            "--layers {}: the print has layers 0 to {} only; choose a range within",
            asked->layers() == 1 ? fmt::format("{}", asked->first) : fmt::format("{}-{}", asked->first, asked->last),
            layers - 1));
    return {asked->first, std::min(asked->last, layers - 1)};
}

BackingChoice::BackingChoice(optics::Backing of) : kind(of), words(name_of(of)) {}

BackingChoice parse_backing(std::string_view key, const std::string& words) {
    if (const auto known = value_of<optics::Backing>(words)) return *known;
    const auto require = [&](bool good, std::string_view rule) {
        if (!good) throw UsageError(fmt::format("--{} {}: {}", key, words, rule));
    };
    constexpr std::string_view grey = "grey:", checker = "checker:";
    constexpr double widest_mm = 1000;
    BackingChoice sheet;
    sheet.kind = optics::Backing::sheet;
    sheet.words = words;
    if (words.starts_with(grey)) {
        const auto share = parse_number<double>(key, words.substr(grey.size()));
        require(share >= 0 && share <= 1, "how much a grey sheet sends back is a number from 0 to 1");
        sheet.linear_rgb.fill(share);
    } else if (words.starts_with(checker)) {
        sheet.checker_mm = parse_length_mm(words.substr(checker.size()), key);
        require(sheet.checker_mm >= 0.01 && sheet.checker_mm <= widest_mm, "squares are 0.01 to 1000 mm wide");
    } else if (const auto rgb = colour_in(words)) {
        sheet.linear_rgb = *rgb;
    } else {
        require(words.find('.') != std::string::npos && words[0] != '#' && !io::is_model_name(words),
                fmt::format("is none of {}", backing_words));
        sheet.picture = words;
    }
    return sheet;
}

}  // namespace voxtone::slicer
