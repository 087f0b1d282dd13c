// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resin sets as JSON files (format "voxtone-resins", data/resins/, data/schema/resins.schema.json).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "optics/media/resins.h"

namespace voxtone::io {

/// Throws InputError that names file, key and rule.
[[nodiscard]] optics::ResinSet parse_resin_set(std::string_view text, std::string source);
/// Throws FileError, InputError.
[[nodiscard]] optics::ResinSet read_resin_set(const std::filesystem::path& file);
/// Every number as short as it can be and still read back as the same.
[[nodiscard]] std::string resin_set_text(const optics::ResinSet& set);

/// The set with 6 digits of every number that was fitted, of an albedo of what it leaves to 1 (9 decimals at most), so
/// that files have the same bytes: functions of libm differ in their last bits by processor, and fits by up to 1e-9.
/// Nobody measures that many.
[[nodiscard]] optics::ResinSet rounded_set(optics::ResinSet set);

/// Names of the sets that come with the program.
[[nodiscard]] std::vector<std::string> known_resin_sets();
/// The JSON of a set that comes with the program; nothing for other names.
[[nodiscard]] std::optional<std::string_view> known_resin_set_text(std::string_view name);
/// A set that comes with the program by its name, or one from a file. Throws InputError naming the sets there are.
[[nodiscard]] optics::ResinSet find_resin_set(const std::string& name_or_file);

}  // namespace voxtone::io
