// SPDX-License-Identifier: GPL-3.0-or-later
//
// Patches of a calibration target as a table (io/files/csv_table.h) with a header line; lines that begin with # are
// comments.
//
//   top,backing,thickness_mm,R,G,B                          or      top,backing,thickness_mm,400,425,...
//
// `top` is a role or a mixture in percent, "C:10+W:90"; `backing` a role, or the light that falls from behind upon a
// slab in air of which the values say what share comes through: "light" from all sides, or a "beam"
// (slab_transmission.h), or a surface (patch_surfaces.h), which has a row of its own: `top` is "bare:matt",
// "bare:smooth" or "bare:mirror", "+gap" after it where air lies under the squares, thickness_mm 0. L,a,b or X,Y,Z may
// stand in place of R,G,B (measured_values.h). Optional columns, anywhere after the first three: `base_mm` (thickness
// of the base), the standard error of a channel, `R_se`, `400_se`, and `cell_x_mm`, `cell_y_mm` of squares whose two
// resins lie as a checker.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

/// Whether the header is that of a target, or there is none.
[[nodiscard]] bool is_target_csv(std::string_view text);

/// Throws InputError that names file, line, column and patch: missing columns, rows of another length, values that are
/// no numbers, negative or above 1, fractions that do not sum to 100, a patch measured twice with different values (a
/// row that says the same again is left out). Where a standard error is given, a value may lie six of them below 0:
/// noise. Of Lab and XYZ: what make_rho refuses (measured_values.h).
[[nodiscard]] PatchTable read_target_csv(std::string_view text, std::string source,
                                         std::optional<optics::Illuminant> illuminant);

/// Contract: not a chart.
[[nodiscard]] std::string target_csv_text(const PatchTable& table, std::string_view comment);

}  // namespace voxtone::calibration
