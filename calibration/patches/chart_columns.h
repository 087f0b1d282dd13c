// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the columns of a chart of mixtures mean, by their names: of tables that people write and of CGATS alike.
//
//   W, C, Cyan, ...                    share of the resin of that role: every name that means nothing else
//   CMYK_C, CMYK_M, CMYK_Y, CMYK_K     ink percentages; with no white beside them, W is the rest
//   3CLR_1..3, 4CLR_1..4               the same, as C, M, Y (K)
//   L, a, b or LAB_L, LAB_A, LAB_B     CIELAB
//   X, Y, Z or XYZ_X, XYZ_Y, XYZ_Z     a plain Y is luminance between X and Z, and else a resin
//   R, G, B                            linear, where nothing else is measured, and else resins
//   400, 400 nm, NM_400, SPECTRAL_NM400, SPECTRAL_400, SPEC_400      a wavelength
//   thickness_mm, backing, base_mm     of the patch
//   NAME_se                            standard error of a measured column
//   row, column                        place on the printed chart, from 1
//   SAMPLE_ID, name, LCH_C, ...        known, and not used
//
// Where several quantities are measured, spectra go before L, a, b, and these before X, Y, Z.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/patches/chart_reading.h"

namespace voxtone::calibration {

struct ChartColumns {
    enum class Kind { unused, share, thickness, backing, base, value, error, row, column };
    struct Column {
        Kind kind = Kind::unused;
        std::size_t index = 0;  ///< of the share, or of the channel
        std::string name;       ///< as the file writes it
    };
    std::vector<Column> columns;
    std::vector<std::string> roles;  ///< of the shares
    Quantity quantity = Quantity::lab;
    std::vector<double> wavelengths_nm;  ///< rising
    bool has_errors = false;
    bool rest_is_white = false;
    std::string note;  ///< what was assumed; empty: nothing

    [[nodiscard]] std::size_t channels() const { return quantity == Quantity::spectrum ? wavelengths_nm.size() : 3; }
};

/// `where` begins the messages of the InputError: nothing is measured, no resin, a column twice, a part of L, a, b, an
/// error without its channel, device RGB, a Y that may be yellow.
[[nodiscard]] ChartColumns chart_columns(std::span<const std::string_view> names, const std::string& where);

/// Whether nothing is measured in a row: every measured cell is empty. Contract: as many cells as columns.
[[nodiscard]] bool is_unmeasured(const ChartColumns& columns, std::span<const std::string_view> cells);

/// A row as a patch of a ChartReading. Contract: as many cells as columns. Throws InputError for what is no number.
[[nodiscard]] Patch chart_row(const ChartColumns& columns, std::span<const std::string_view> cells, std::string where);

}  // namespace voxtone::calibration
