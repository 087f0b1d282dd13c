// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/column_meaning.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <vector>

#include "calibration/tables/table_cells.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {

namespace {

using Of = ColumnMeaning::Of;
using Chunks = std::vector<std::string>;

constexpr std::string_view letters_of_inks = "CMYKWTRGBOV", letters_of_devices = "CMYKWTRGBOVNcmyk";

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

template <std::size_t n>
bool is_among(const std::array<std::string_view, n>& words, std::string_view word) {
    return std::ranges::find(words, word) != words.end();
}

// "L*(10°/D65)" -> L, 10, D65; "SPECTRAL_NM400.5" -> SPECTRAL, NM400.5
Chunks chunks_of(std::string_view name) {
    Chunks chunks(1);
    for (std::size_t i = 0; i < name.size(); ++i) {
        const bool decimal = (name[i] == '.' || name[i] == ',') && i > 0 && is_digit(name[i - 1]) &&
                             i + 1 < name.size() && is_digit(name[i + 1]);
        if (is_letter(name[i]) || is_digit(name[i]))
            chunks.back() += name[i];
        else if (decimal)
            chunks.back() += '.';
        else if (!chunks.back().empty())
            chunks.emplace_back();
    }
    if (chunks.back().empty()) chunks.pop_back();
    return chunks;
}

// Takes a word that says how was measured.
bool take_way(std::string_view capitals, MeasuredWay& way) {
    constexpr std::array<std::string_view, 6> modes{"SCI", "SCE", "M0", "M1", "M2", "M3"};
    constexpr std::array<std::string_view, 9> illuminants{"D50", "D55", "D65", "D75", "F2", "F7", "F11", "F12", "TL84"};
    if (is_among(modes, capitals)) return way.mode = capitals, true;
    if (is_among(illuminants, capitals)) return way.illuminant = capitals, true;
    return false;
}

bool take_observer(std::string_view capitals, MeasuredWay& way) {
    constexpr std::array<std::string_view, 4> two{"2", "2DEG", "2DEGREE", "1931"};
    constexpr std::array<std::string_view, 4> ten{"10", "10DEG", "10DEGREE", "1964"};
    if (is_among(two, capitals)) return way.observer = "2", true;
    if (is_among(ten, capitals)) return way.observer = "10", true;
    return capitals == "DEG" || capitals == "DEGREE" || capitals == "OBSERVER";
}

std::optional<ColumnMeaning> measured_letter(std::string_view name) {
    struct Entry {
        const char* name;
        Quantity quantity;
        std::size_t channel;
    };
    static constexpr Entry letters[] = {{"L", Quantity::lab, 0},  {"a", Quantity::lab, 1},  {"b", Quantity::lab, 2},
                                        {"L*", Quantity::lab, 0}, {"a*", Quantity::lab, 1}, {"b*", Quantity::lab, 2},
                                        {"X", Quantity::xyz, 0},  {"Y", Quantity::xyz, 1},  {"Z", Quantity::xyz, 2},
                                        {"R", Quantity::rgb, 0},  {"G", Quantity::rgb, 1},  {"B", Quantity::rgb, 2}};
    for (const Entry& entry : letters)
        if (name == entry.name)
            return ColumnMeaning{.of = Of::quantity,
                                 .role = std::string(name),
                                 .quantity = entry.quantity,
                                 .channel = entry.channel,
                                 .plain = true};
    return std::nullopt;
}

// A coordinate with words around it that make it one: "CIE L", "LAB_A", "L*(D50)", "XYZ_Y", "b* SCI 10°".
std::optional<ColumnMeaning> measured_words(std::string_view name, const Chunks& chunks) {
    constexpr std::array<std::string_view, 2> of_lab{"LAB", "CIELAB"};
    constexpr std::array<std::string_view, 3> of_xyz{"XYZ", "CIEXYZ", "TRISTIMULUS"};
    MeasuredWay way;
    bool lab = name.find('*') != std::string_view::npos, xyz = false, either = false;
    std::string letter;
    for (const std::string& chunk : chunks) {
        const std::string capitals = in_capitals(chunk);
        if (is_among(of_lab, capitals)) {
            lab = true;
        } else if (is_among(of_xyz, capitals)) {
            xyz = true;
        } else if (capitals == "CIE" || take_way(capitals, way)) {
            either = true;
        } else if (!take_observer(capitals, way)) {
            if (!letter.empty() || chunk.size() != 1) return std::nullopt;
            letter = chunk;
        }
    }
    if (letter.empty() || !(lab || xyz || either)) return std::nullopt;
    // Chroma, hue and chromaticity follow from what is taken.
    if (!xyz && (letter == "C" || letter == "h" || letter == "H")) return ColumnMeaning{.of = Of::unused};
    const std::size_t at = std::string_view("LAB").find(in_capitals(letter)), of = std::string_view("XYZ").find(letter);
    ColumnMeaning meaning{.of = Of::quantity, .role = std::string(name)};
    meaning.way = way;
    if (!xyz && at != std::string_view::npos) {
        meaning.quantity = Quantity::lab, meaning.channel = at;
    } else if (!lab && of != std::string_view::npos) {
        meaning.quantity = Quantity::xyz, meaning.channel = of;
    } else {
        return std::nullopt;
    }
    return meaning;
}

// A number of nm with words around it that say so: "R_380nm", "SPECTRAL_PCT_380", "380 nm", "R380 (SCI)".
std::optional<ColumnMeaning> wavelength(const Chunks& chunks) {
    constexpr std::array<std::string_view, 7> sure{"", "NM", "SPECTRAL", "SPEC", "SPECTRUM", "WAVELENGTH", "WL"};
    constexpr std::array<std::string_view, 8> likely{"R", "REF", "REFL", "REFLECTANCE", "RHO", "PCT", "DEC", "LAMBDA"};
    constexpr double seen_from = 300, seen_to = 1100;
    ColumnMeaning meaning{.of = Of::wavelength};
    std::optional<double> nm;
    bool certain = true;
    for (const std::string& chunk : chunks) {
        const std::string capitals = in_capitals(chunk);
        if (take_way(capitals, meaning.way)) continue;
        const auto from = static_cast<std::size_t>(std::ranges::find_if(capitals, is_digit) - capitals.begin());
        const std::string_view word = std::string_view(capitals).substr(0, from);
        if (!is_among(sure, word)) {
            if (!is_among(likely, word)) return std::nullopt;
            certain = false;
        }
        if (from == capitals.size()) continue;
        std::string_view digits = std::string_view(capitals).substr(from);
        if (digits.ends_with("NM")) digits.remove_suffix(2);
        const auto value = number(digits);
        if (nm || !value) return std::nullopt;
        nm = *value;
    }
    if (!nm || !(certain || (*nm >= seen_from && *nm <= seen_to))) return std::nullopt;
    meaning.nm = *nm;
    return meaning;
}

// What programs and people write beside the measurement.
bool is_bookkeeping(std::string_view capitals) {
    static const std::set<std::string_view> names{"",
                                                  "ID",
                                                  "NAME",
                                                  "NO",
                                                  "NR",
                                                  "NUMBER",
                                                  "INDEX",
                                                  "PATCH",
                                                  "PATCH_ID",
                                                  "COL",
                                                  "PAGE",
                                                  "STRIP",
                                                  "PLACE",
                                                  "ORDER",
                                                  "DATE",
                                                  "TIME",
                                                  "COMMENT",
                                                  "COMMENTS",
                                                  "NOTE",
                                                  "NOTES",
                                                  "INFO",
                                                  "STRING",
                                                  "TAG",
                                                  "REPEAT",
                                                  "LCH_L",
                                                  "LCH_C",
                                                  "LCH_H",
                                                  "INSTRUMENT",
                                                  "LAB_C",
                                                  "LAB_H",
                                                  "XYY_X",
                                                  "XYY_Y",
                                                  "CHI_SQD_PAR",
                                                  "SPECTRAL_NM",
                                                  "XYY_CAPY",
                                                  "SPECTRAL_PCT",
                                                  "SPECTRAL_DEC"};
    return names.contains(capitals) || capitals.starts_with("SAMPLE") || capitals.starts_with("D_") ||
           capitals.starts_with("DE_") || capitals.starts_with("STDEV_") || capitals.starts_with("MEAN_");
}

// "6CLR_2" or "SIXCLR_2" -> 2.
std::optional<std::size_t> numbered_ink(std::string_view capitals) {
    const std::size_t at = capitals.find("CLR_");
    if (at == 0 || at == std::string_view::npos) return std::nullopt;
    const auto value = number(capitals.substr(at + 4));
    if (!value || *value < 1 || *value > 15) return std::nullopt;
    return static_cast<std::size_t>(*value);
}

// "CMYKOG_O": the ink is O, and CMYKOG are all inks of the device, by the file's word or by their letters.
std::optional<ColumnMeaning> named_ink(std::string_view name, std::string_view device) {
    if (name.size() < 5 || name[name.size() - 2] != '_') return std::nullopt;
    std::string inks(name.substr(0, name.size() - 2)), ink(1, name.back());
    // cmyk_c; in CMYKcm_c the small letters are light inks.
    if (std::ranges::none_of(inks, [](char c) { return c >= 'A' && c <= 'Z'; }))
        inks = in_capitals(inks), ink = in_capitals(ink);
    if (inks == "CMYK") ink = in_capitals(ink);
    if (inks.find(ink) == std::string::npos || std::string_view(inks).starts_with("RGB")) return std::nullopt;
    const bool of_letters = inks.size() >= 3 && std::ranges::all_of(inks, [](char c) {
                                return letters_of_devices.find(c) != std::string_view::npos;
                            });
    const bool told = !device.empty() && inks == device;
    const bool distinct = std::set(inks.begin(), inks.end()).size() == inks.size();
    if (!distinct || !(of_letters || told)) return std::nullopt;
    return ColumnMeaning{.of = Of::ink, .role = ink};
}

std::string lower(std::string_view text) {
    std::string small(text);
    std::ranges::transform(small, small.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return small;
}

ColumnMeaning meaning_of_name(std::string_view name, const ColumnWords& words) {
    const std::string capitals = in_capitals(name);
    if (capitals == "THICKNESS_MM") return {.of = Of::thickness};
    if (capitals == "BASE_MM") return {.of = Of::base};
    if (capitals == "BACKING") return {.of = Of::backing};
    if (capitals == "RGB_R" || capitals == "RGB_G" || capitals == "RGB_B") return {.of = Of::device_rgb};
    if (const auto letter = measured_letter(name)) return *letter;
    if (words.names(name)) return {.of = Of::role, .role = std::string(name)};
    if (capitals == "ROW") return {.of = Of::row};
    if (capitals == "COLUMN") return {.of = Of::column};
    if (is_bookkeeping(capitals)) return {.of = Of::unused};
    if (const auto ink = named_ink(name, words.device)) return *ink;
    if (const auto ink = numbered_ink(capitals)) return {.of = Of::numbered_ink, .channel = *ink - 1};
    const Chunks chunks = chunks_of(name);
    if (const auto nm = wavelength(chunks)) return *nm;
    if (const auto measured = measured_words(name, chunks)) return *measured;
    if (is_known_role(name)) return {.of = Of::role, .role = std::string(name)};
    return {.of = Of::unknown, .role = std::string(name)};
}

}  // namespace

bool ColumnWords::names(std::string_view role) const {
    const auto among = [&](std::span<const std::string> roles) {
        return std::ranges::find(roles, role) != roles.end();
    };
    return among(resins) || among(known);
}

ColumnMeaning column_meaning(std::string_view name, const ColumnWords& words) {
    if (name.ends_with("_se")) {
        ColumnMeaning meaning = meaning_of_name(name.substr(0, name.size() - 3), words);
        meaning.error = true;
        if (meaning.of == Of::quantity || meaning.of == Of::wavelength) return meaning;
    }
    return meaning_of_name(name, words);
}

bool is_known_role(std::string_view name) {
    if (name.size() == 1 && letters_of_inks.find(name[0]) != std::string_view::npos) return true;
    static const std::set<std::string> of_sets = [] {
        std::set<std::string> names;
        for (const std::string& known : io::known_resin_sets())
            for (const optics::Resin& resin : io::find_resin_set(known).resins)
                names.insert(resin.role), names.insert(resin.name);
        return names;
    }();
    if (of_sets.contains(std::string(name))) return true;
    constexpr std::array<std::string_view, 9> inks{"white", "cyan",   "magenta", "yellow",     "black",
                                                   "clear", "orange", "violet",  "transparent"};
    return is_among(inks, lower(name));
}

}  // namespace voxtone::calibration
