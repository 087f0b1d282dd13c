// SPDX-License-Identifier: GPL-3.0-or-later
//
// A chart of mixtures as a table of text: a header line, then one line per measured patch.
//
//   W,C,M,Y,K,L,a,b             or      name;W;C;thickness_mm;backing;400;410;...;700
//   90,10,0,0,0,71.2,-19.4,-8           A1;0,9;0,1;0,5;K;0,312;0,32;...;0,55
//
// Columns stand in any order (chart_columns.h), separated as io/files/csv_table.h says; numbers may have a decimal
// comma where commas do not separate. Lines that begin with # are comments; "# illuminant: D65", "# observer: 2" and,
// above the header, "# resins: W,C,Vio" are read. Titles above the header are left aside, said.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibration/patches/chart_columns.h"
#include "calibration/patches/chart_reading.h"

namespace voxtone::calibration {

/// Throws InputError that names file, line and column.
[[nodiscard]] ChartReading read_chart_csv(std::string_view text, const std::string& source, ColumnWords words = {});

/// "# resins: W,C,Vio" where not all of them are known as resins by their names; else nothing.
[[nodiscard]] std::string resins_comment(const std::vector<std::string>& roles);

/// A chart as such a table, which reads back as the same: shares as fractions, L,a,b or wavelengths or R,G,B, columns
/// of thickness and backing where a patch has them. Contract: a chart.
[[nodiscard]] std::string chart_csv_text(const PatchTable& table, std::string_view comment);

}  // namespace voxtone::calibration
