// SPDX-License-Identifier: GPL-3.0-or-later
//
// A chart of mixtures as a file writes it, whatever its format, and the table that it becomes.
//
// Shares are fractions of the volume or percent, told apart by the sums of all rows together. They must sum to 1 within
// 0.2 %, and sum to it exactly afterwards. Ink percentages of a device (CMYK) say what lies beside white, whose share
// is the rest; each may be off by half a step of 8 bits, so that four sum to 100.8 at most. Where the device has a
// white ink, rows without any ink are bare paper, and are left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/patches/measured_values.h"
#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

inline constexpr std::size_t most_chart_patches = 100000;

struct ChartReading {
    PatchTable table;  ///< `top`: every resin with its share as written, 0 too; `rho`, `error`: as written
    Quantity quantity = Quantity::lab;
    MeasuringConditions conditions;
    std::size_t inks = 0;                 ///< shares that are ink percentages of a device; 0: none is
    bool rest_is_white = false;           ///< all are, and W is the rest
    bool behind_curves = false;           ///< the inks are those behind the printer's calibration curves
    std::vector<std::string> aside = {};  ///< names of columns that were taken for nothing
};

struct ChartRules {
    std::optional<optics::Illuminant> illuminant = {};  ///< of Lab and XYZ; none: what the file says, else D50
    /// Rows that no volume can hold are left out, said, where the chart is else refused.
    bool printable_only = false;
};

/// Throws InputError that names the row: shares below 0, sums that are not 1, ink percentages above 100 together (and
/// how many rows would do), thickness without backing, one colour for all mixtures, and all that make_rho,
/// check_coverage and check_repeats refuse.
[[nodiscard]] PatchTable finished_chart(ChartReading reading, const ChartRules& rules = {});

/// Group of each patch, counted from 0 in the order of the table: patches of one mixture (shares to 0.0001), thickness,
/// base and backing are repeats.
[[nodiscard]] std::vector<std::size_t> repeat_groups(const PatchTable& table);

/// Two measurements of one mixture that differ by more than this, CIEDE2000, are not both right; of three and more, one
/// that differs by more from their median (by L, a and b) is wrong. Printing black eight times on a J750 gave pairs 5.4
/// apart, the farthest 4.7 from the median.
inline constexpr double most_repeat_difference = 5;
/// Throws InputError that names two such rows. Contract: R, G, B, wavelengths or colorimetric channels.
void check_repeats(const PatchTable& table);

}  // namespace voxtone::calibration
