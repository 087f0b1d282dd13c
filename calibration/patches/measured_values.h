// SPDX-License-Identifier: GPL-3.0-or-later
//
// From numbers as instruments and files give them to rho, and back.
//
//   R, G, B     linear, rho itself
//   spectrum    reflectance in shares of a perfect diffuser, or in percent: recognised by a value above 2 anywhere
//   L, a, b     CIELAB, 2 degree observer; rho = X/Xn, Y/Yn, Z/Zn by CIE 15:2018, Eq. 8.3 turned round
//   X, Y, Z     2 degree observer, white Y = 1 or 100: recognised by a value above 2 anywhere; rho = X/Xn, Y/Yn, Z/Zn
//
// Scales are recognised for the whole table, never for one value. Values are never clamped: what lies a little below 0
// or above 1 stays so and is counted in a note.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/patches/patch_table.h"
#include "calibration/tables/text_table.h"
#include "optics/colour/spectral_colour.h"

namespace voxtone::calibration {

/// What the numbers of a table are.
enum class Quantity { rgb, spectrum, lab, xyz };

/// How colours were computed from what was measured, in the file's words; empty: it does not say. Spectra need neither.
struct MeasuringConditions {
    std::string illuminant = {};  ///< "D50"
    std::string observer = {};    ///< "2 degree"
    std::string white_base = {};  ///< what is white: "Paper", "Abs"
    std::string filter = {};      ///< before the instrument: "Pol", "UV", "No"
};

/// Keeps what a file says under a name: `ILLUMINANT D50`, `OBSERVER "2 degree"`, and what measuring programs call
/// these.
void note_condition(MeasuringConditions& conditions, std::string_view name, std::string_view value);
/// All that the words of a table say.
[[nodiscard]] MeasuringConditions conditions_of(const TextTable& table);

/// How far values of a chart may lie outside of [0, 1]; beyond it they are no reflectances.
inline constexpr double least_rho = -0.1, most_rho = 1.5;

/// Takes a table whose `rho` and `error` are numbers as written, sets its channels (those of a spectrum are there
/// already) and turns the numbers into rho. `illuminant` is the user's word and goes before the file's; where neither
/// names one, Lab and XYZ are taken as D50, and a note says so. Throws InputError for an illuminant that is not known,
/// Lab or XYZ of the 10 degree observer, values relative to the paper, an L* outside [-1, 110], a rho outside
/// [least_rho, most_rho], and errors that are not above 0.
void make_rho(PatchTable& table, Quantity quantity, const MeasuringConditions& conditions,
              std::optional<optics::Illuminant> illuminant);

/// Throws InputError unless the table's wavelengths cover 420 to 680 nm: what is left out there decides the colour.
void check_coverage(const PatchTable& table);

/// How a table's values are written: names of columns, and the numbers of a patch with its standard errors if
/// `with_errors`. Colorimetric channels are written as L, a, b, with errors as X, Y, Z, wide ones as wR, wG, wB.
/// Contract: R, G, B, wavelengths, wide or colorimetric channels.
[[nodiscard]] std::vector<std::string> written_names(const optics::Channels& channels, bool with_errors);
[[nodiscard]] std::vector<double> written_values(const optics::Channels& channels, const Patch& patch,
                                                 bool with_errors);
/// "illuminant: D65", a comment that is read again, where the values need it; otherwise empty.
[[nodiscard]] std::string written_illuminant(const optics::Channels& channels);

}  // namespace voxtone::calibration
