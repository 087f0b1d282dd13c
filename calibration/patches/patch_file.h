// SPDX-License-Identifier: GPL-3.0-or-later
//
// Patch measurements as CSV with a header line; lines that begin with # are comments.
//
//   top,backing,thickness_mm,R,G,B                          or      top,backing,thickness_mm,400,425,...
//
// `top` is a role or a mixture in percent, "C:10+W:90"; `backing` a role. Optional columns, anywhere after the first
// three: `base_mm` (thickness of the base) and the standard error of a channel, `R_se`, `400_se`.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "voxtone/calibration/patches/patch_table.h"

namespace voxtone::calibration {

/// "C:10+W:90" and back. Throws InputError.
[[nodiscard]] PatchMixture parse_mixture(std::string_view text);
[[nodiscard]] std::string mixture_text(const PatchMixture& mixture);

/// "C:10+W:90 on K", for messages.
[[nodiscard]] std::string patch_name(const Patch& patch);

/// Throws InputError that names file, line, column and patch: missing columns, rows of another length, values that are
/// no numbers, negative or above 1, fractions that do not sum to 100, a patch measured twice with different values (a
/// row that says the same again is left out). Where a standard error is given, a value may lie six of them below 0:
/// noise.
[[nodiscard]] PatchTable parse_patches(std::string_view text, std::string source);
/// Throws FileError, InputError.
[[nodiscard]] PatchTable read_patches(const std::filesystem::path& file);
/// Values that were divided by those of a white reference become relative to a perfect diffuser: times the reference's
/// own reflectance (0.99 for Spectralon of 99 %), errors too. Throws InputError unless it lies in (0, 1].
void apply_white_reference(PatchTable& table, double reflectance);
/// `comment`: written before the header, a # before each of its lines.
[[nodiscard]] std::string patch_table_text(const PatchTable& table, std::string_view comment = {});

}  // namespace voxtone::calibration
