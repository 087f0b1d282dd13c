// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small charts of our own making, in the formats that are read. Their colours are invented.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/patches/patch_file.h"

namespace voxtone::test {

inline calibration::PatchTable parsed(const std::string& text, std::optional<optics::Illuminant> illuminant = {}) {
    return calibration::parse_patches(text, "chart", {.illuminant = illuminant});
}

/// Where the user names resins, or wants the rows alone that a volume can hold.
inline calibration::PatchTable parsed_with(const std::string& text, std::vector<std::string> resins,
                                           bool printable_only = false) {
    return calibration::parse_patches(
        text, "chart",
        {.illuminant = optics::Illuminant::d50, .resins = std::move(resins), .printable_only = printable_only});
}

/// All notes of a table.
inline std::string notes_of(const calibration::PatchTable& table) {
    std::string notes;
    for (const std::string& note : table.notes) notes += note + "\n";
    return notes;
}

/// The message of the error that the text must cause.
inline std::string chart_fault(const std::string& text, std::optional<optics::Illuminant> illuminant = {}) {
    try {
        (void)parsed(text, illuminant);
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL("accepted: " << text.substr(0, 2000));
    return {};
}

/// Every text with one byte after another cut off, or changed, is read or refused with a sentence.
template <class Check>
void for_each_cut(const std::string& text, Check check) {
    for (std::size_t length = 0; length < text.size(); ++length) check(text.substr(0, length));
}

inline void survive_damage(const std::string& text) {
    for (std::size_t at = 0; at < text.size(); ++at)
        for (const char c : {'\0', '\n', ',', '"', '<', '/', '-', '9', '\xff'}) {
            std::string damaged = text;
            damaged[at] = c;
            try {
                (void)parsed(damaged);
            } catch (const InputError&) {
            }
        }
}

/// A smooth spectrum between `low` and `high`, as the numbers of a row.
inline std::string spectrum_row(double from, double to, double step, double low, double high, const char* between) {
    std::string row;
    for (double nm = from; nm <= to; nm += step)
        row += fmt::format("{}{:.4f}", row.empty() ? "" : between, low + (high - low) * (nm - from) / (to - from));
    return row;
}

}  // namespace voxtone::test
