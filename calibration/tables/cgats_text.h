// SPDX-License-Identifier: GPL-3.0-or-later
//
// CGATS.17 text and its relatives (IT8.7, the tables of Argyll): keywords, a list of fields, rows of values.
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
// Values are separated by blanks or tabs, a value with blanks has quotes, # begins a comment, lines end by LF, CR LF or
// CR; a row may go on over several lines. A quote within a quoted value is doubled. A file may hold several tables.
// Files that a spreadsheet has saved as CSV are read, too.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/tables/text_table.h"

namespace voxtone::calibration {

/// The tables of such a text, one after another.
class CgatsText : public TextTable {
public:
    /// `text` outlives it.
    CgatsText(std::string_view text, std::string source);

    /// Whether a text is CGATS or a relative, by its content.
    [[nodiscard]] static bool is(std::string_view text);

    /// Goes on to the next table, or the next of this kind; what lies between is not looked at. Throws InputError: a
    /// list of fields that is cut short, or that NUMBER_OF_FIELDS contradicts.
    bool next_table(std::string_view of_kind = {});
    /// What the table calls itself: "CGATS.17", "CTI3", "CAL"; empty: nothing.
    [[nodiscard]] const std::string& kind() const { return kind_; }
    /// All inks of the device, "CMYK" of COLOR_REP "CMYK_LAB"; empty: not said.
    [[nodiscard]] const std::string& device() const { return device_; }
    /// Throws InputError: rows of another length than the fields, a table that is cut short or that NUMBER_OF_SETS
    /// contradicts.
    bool next() override;

private:
    using Words = std::vector<std::string_view>;
    bool next_line(Words& words);
    [[nodiscard]] Words words_of_cells() const;
    void keyword(const std::string& key, const Words& words);
    void read_format(Words words);
    bool complete(Words& row, const Words& words) const;
    void expect_number_of_sets();

    std::string_view text_, text_of_line_;
    char separator_;
    std::string unquoted_line_, kind_, device_;
    bool in_rows_ = false;
    std::size_t at_ = 0, last_line_ = 0, rows_ = 0;
    std::optional<double> number_of_fields_, number_of_sets_;
};

}  // namespace voxtone::calibration
