// SPDX-License-Identifier: GPL-3.0-or-later
//
// A chart as CGATS text (calibration/tables/cgats_text.h), as measuring programs export it.
//
// Fields mean what chart_columns.h says. Numbers may have a decimal comma. Of several tables the first with mixtures
// and measured values is taken, and a CAL table (device_curves.h) before or behind it tells what was printed of its
// inks. Illuminant and observer of L, a, b are read from WEIGHTING_FUNCTION, ILLUMINATION_NAME, OBSERVER_ANGLE,
// ILLUMINANT, OBSERVER, MEASUREMENT_SOURCE.
#pragma once

#include <string>
#include <string_view>

#include "calibration/patches/chart_columns.h"
#include "calibration/patches/chart_reading.h"

namespace voxtone::calibration {

/// Throws InputError that names file, line and field: a file that is cut short, counts that do not agree, no table that
/// can be used, Argyll's CTI1 and CTI2, which hold colours that are expected, and curves that do not fit.
[[nodiscard]] ChartReading read_cgats(std::string_view text, const std::string& source, ColumnWords words = {});

}  // namespace voxtone::calibration
