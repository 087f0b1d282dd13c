// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the text of an option to its value. Each throws UsageError that names the option, the text and the rule.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "base/named_values.h"
#include "io/shards/shard_number.h"
#include "optics/scene/backing.h"
#include "slicer/options/placement_options.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// What the file is that stands in a model's place, by its name; a text also by its first line. What the options say
/// of a tray's plan is meant for the parts, of which each has a scope of its own.
enum class ModelKind : std::uint8_t { mesh, picture, tray_plan };
[[nodiscard]] ModelKind model_kind(const std::string& model);

/// "--KEY: 'TEXT' is none of A, B".
[[noreturn]] void refuse_choice(std::string_view key, std::string_view text, const std::vector<std::string>& choices);
/// "--KEY: 'TEXT' is not a number".
[[noreturn]] void refuse_number(std::string_view key, std::string_view text);

template <class Enum>
[[nodiscard]] Enum parse_choice(std::string_view key, std::string_view text) {
    const std::optional<Enum> value = value_of<Enum>(text);
    if (!value) refuse_choice(key, text, names_of<Enum>());
    return *value;
}

/// The whole text; finite.
template <class Number>
[[nodiscard]] Number parse_number(std::string_view key, std::string_view text) {
    Number number{};
    const auto [rest, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    bool good = status == std::errc{} && rest == text.data() + text.size() && !text.empty();
    if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(number);
    if (!good) refuse_number(key, text);
    return number;
}

/// "true", "on", "yes", "1" or "false", "off", "no", "0".
[[nodiscard]] bool parse_flag(std::string_view key, std::string_view text);

/// The parts between commas that are not empty.
[[nodiscard]] std::vector<std::string> parse_list(const std::string& text);

inline constexpr const char* backing_words =
    "black, white, none, grey:0.5 (how much it sends back), #rrggbb, checker:2mm or a picture as large as the slab";

inline constexpr const char* illuminant_words =
    "lamp that the print is looked at by: D65, D50, A, F2, F11, LED-B1, LED-B3 (of the CIE), a black body (2700K) or a "
    "table of its power (lamp.csv: nm,power); all but D65 want a resin set of wavelengths";

/// What lies under a picture's slab.
struct BackingChoice {
    optics::Backing kind = optics::Backing::black;
    std::string words = "black";  ///< as it is written
    // Of a sheet that is neither black nor white the first of these that is there:
    std::string picture = {};            ///< file
    double checker_mm = 0;               ///< edge of the squares, black and white
    std::array<double, 3> linear_rgb{};  ///< the same everywhere

    BackingChoice() = default;
    BackingChoice(optics::Backing of);  // NOLINT(google-explicit-constructor): each is a choice
    friend bool operator==(const BackingChoice& a, const BackingChoice& b) { return a.words == b.words; }
    friend bool operator==(const BackingChoice& a, optics::Backing b) { return a.kind == b; }
};
[[nodiscard]] BackingChoice parse_backing(std::string_view key, const std::string& words);

/// "auto": nothing, the file's own.
[[nodiscard]] std::optional<FileUnit> parse_file_unit(const std::string& text);

/// Right-handed rotation from "x90" or "z45,x-30" (degrees, applied in this order).
[[nodiscard]] Eigen::Matrix3d parse_rotation(const std::string& text);

/// Of `iterations`: as auto, and longer while it gains.
inline constexpr std::string_view patient_word = "long";
/// Most iterations of the loop, 0 to 1000; "auto", "long": nothing.
[[nodiscard]] std::optional<int> parse_iterations(const std::string& text);

/// A number from 0 to `most`; "auto": nothing. `or_else`: what is no number, for who is refused.
[[nodiscard]] std::optional<int> parse_count_or_auto(std::string_view key, const std::string& text, int most,
                                                     std::string_view or_else = "or auto");

/// First and last layer that are asked for, inclusive.
struct LayerRange {
    int first = 0;
    int last = -1;
    [[nodiscard]] int layers() const { return last - first + 1; }
};
/// "i/n", such as 3/16. Nothing for "auto" and for nothing. Throws UsageError.
[[nodiscard]] std::optional<io::ShardNumber> parse_shard(const std::string& text);
/// "a-b" or "a"; empty: nothing, all layers.
[[nodiscard]] std::optional<LayerRange> parse_layer_range(const std::string& text);
/// `asked` in a print of so many layers; nothing: all. What lies past the end is left out; throws InputError where
/// nothing is left.
[[nodiscard]] LayerRange range_within(const std::optional<LayerRange>& asked, int layers);

}  // namespace voxtone::slicer
