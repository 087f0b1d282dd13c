// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the columns of a chart of mixtures mean together: of tables that people write and of CGATS alike. What a name
// means by itself: column_meaning.h.
//
//   shares       of resins that are known by their names, or that the user names; ink percentages of a device, with no
//                white beside them: W is the rest
//   Y            luminance between X and Z, and else a resin
//   R, G, B      linear, where nothing else is measured, and else resins
//   A, B         a and b beside an L, where nothing else can be; l, a, b and c, m, y, k, w in small letters
//   thickness_mm, backing, base_mm     of the patch
//   NAME_se      standard error of a measured column
//   row, column  place on the printed chart, from 1
//   SAMPLE_ID, name, LCH_C, ...        known, and not used
//   all else     left aside, and named
//
// Where several quantities are measured, spectra go before L, a, b, and these before X, Y, Z; of several ways to
// measure one (SCI and SCE, M0 and M1, D50 and D65) the first of the 2 degree observer that is complete.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/patches/chart_reading.h"
#include "calibration/patches/column_meaning.h"
#include "calibration/tables/text_table.h"

namespace voxtone::calibration {

struct ChartColumns {
    enum class Kind { unused, share, thickness, backing, base, value, error, row, column };
    struct Column {
        Kind kind = Kind::unused;
        std::size_t index = 0;  ///< of the share, or of the channel
    };
    std::vector<Column> columns;
    std::vector<std::string> roles;  ///< of the shares
    Quantity quantity = Quantity::lab;
    std::vector<double> wavelengths_nm;  ///< rising
    bool has_errors = false;
    bool of_inks = false;  ///< some shares are of a device's inks
    bool rest_is_white = false;
    MeasuringConditions conditions;  ///< as far as the names of what is taken tell them
    std::vector<std::string> aside;  ///< names of columns that are neither measured nor a resin that is known
    std::vector<std::string> notes;  ///< what was assumed, a sentence each, without its end

    [[nodiscard]] std::size_t channels() const { return quantity == Quantity::spectrum ? wavelengths_nm.size() : 3; }
};

/// `where` begins the messages of the InputError: nothing is measured, no resin, a column twice, a part of L, a, b, an
/// error without its channel, device RGB, a Y that may be yellow.
[[nodiscard]] ChartColumns chart_columns(std::span<const std::string> names, const std::string& where,
                                         const ColumnWords& words = {});

/// Takes all rows that the table still has, and what it says of them. Rows of which nothing is measured are left out,
/// said. Throws InputError for what is no number, and where nothing is measured at all.
void take_rows(TextTable& table, const ChartColumns& columns, ChartReading& reading);

}  // namespace voxtone::calibration
