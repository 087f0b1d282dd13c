// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measured laminates whose order and thickness are known: each is seen from above, the first layer on top, the
// last one the base, with nothing but darkness under it.
//
// Read from CSV, and from the calibration files of ChromaPrint3D (JSON: "palette", "entries" of {"recipe", "lab"}):
//
//   layers,L,a,b
//   "Y 0.08, W 0.08, W 0.8",92.9,-7.4,18.0        thickness in mm behind each resin's role
//
// Colours are CIELAB of the 2 degree observer, D50 unless told otherwise.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "calibration/patches/patch_table.h"
#include "optics/colour/spectral_colour.h"

namespace voxtone::calibration {

[[nodiscard]] bool is_laminate_file(std::string_view text);
/// A chart of laminates. Throws InputError that names the line or entry.
[[nodiscard]] PatchTable read_laminates(std::string_view text, std::string source,
                                        std::optional<optics::Illuminant> illuminant = {});

}  // namespace voxtone::calibration
