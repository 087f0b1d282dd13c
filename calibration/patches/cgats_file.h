// SPDX-License-Identifier: GPL-3.0-or-later
//
// CGATS.17 text, as measuring programs export charts: keywords, a list of fields, rows of values.
//
//   CGATS.17
//   WEIGHTING_FUNCTION "ILLUMINANT, D50"
//   NUMBER_OF_FIELDS 8
//   BEGIN_DATA_FORMAT
//   SAMPLE_ID CMYK_C CMYK_M CMYK_Y CMYK_K LAB_L LAB_A LAB_B
//   END_DATA_FORMAT
//   NUMBER_OF_SETS 1
//   BEGIN_DATA
//   1 20 0 0 0 71.2 -19.4 -8
//   END_DATA
//
// Fields mean what chart_columns.h says. Values are separated by blanks or tabs, a value with blanks has quotes, #
// begins a comment, lines end by LF, CR LF or CR; a row may go on over several lines. Numbers may have a decimal comma.
// A quote within a quoted value is doubled. A file may hold several tables: the first with mixtures and measured values
// is taken, and a CAL table (device_curves.h) before or behind it tells what was printed of its inks. Illuminant and
// observer of L, a, b are read from WEIGHTING_FUNCTION, ILLUMINATION_NAME, OBSERVER_ANGLE, ILLUMINANT, OBSERVER,
// MEASUREMENT_SOURCE. Files that a spreadsheet has saved as CSV are read, too.
#pragma once

#include <string>
#include <string_view>

#include "calibration/patches/chart_columns.h"
#include "calibration/patches/chart_reading.h"

namespace voxtone::calibration {

/// Whether a text is CGATS or a relative of it (IT8.7, the tables of Argyll): by its content.
[[nodiscard]] bool is_cgats(std::string_view text);

/// Throws InputError that names file, line and field: a file that is cut short, counts that do not agree, no table that
/// can be used, Argyll's CTI1 and CTI2, which hold colours that are expected, and curves that do not fit.
[[nodiscard]] ChartReading read_cgats(std::string_view text, const std::string& source, const ColumnWords& words = {});

}  // namespace voxtone::calibration
