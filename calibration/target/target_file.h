// SPDX-License-Identifier: GPL-3.0-or-later
//
// target.json: the description of a calibration target (format "voxtone-target", version 1), mm throughout; coordinates
// as in target_layout.h. Mixtures are written as in patch tables, "C:10+W:90" (percent).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "calibration/target/target_layout.h"

namespace voxtone::calibration {

[[nodiscard]] std::string target_text(const Target& target);
/// Throws InputError that names file, key, part and rule.
[[nodiscard]] Target parse_target(std::string_view text, const std::string& source);
/// Throws FileError, InputError.
[[nodiscard]] Target read_target(const std::filesystem::path& file);

}  // namespace voxtone::calibration
