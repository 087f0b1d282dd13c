// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tables of text as spreadsheets and measuring programs write them: a header, then rows (RFC 4180, and what programs do
// beyond it). Cells in double quotes may hold separators, line breaks and doubled quotes.
//
//   separator    semicolons or tabs where the header has them outside of quotes, else commas; a first line "sep=;" says
//   lines        end by LF, CR LF or CR; a line break within a cell is LF
//   left out     a byte order mark, blank lines, rows of empty cells, columns at the end without a name and a value,
//                blanks around a cell without quotes
//   comments     lines that begin with #
//
// Texts in UTF-16 are converted before (io/files/utf8.h). Why our own: Debian 12 has no CSV library that tells on which
// line a cell stands.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

struct CsvRow {
    std::size_t line = 0;  ///< on which it begins, 1 for the first of the file
    std::vector<std::string> cells;
};

/// strict: a quote within a cell that does not begin with one is a fault, names of columns differ, and none is empty
/// but those of columns without a value, which are left out. lenient: quotes stay where they stand, names are the
/// caller's.
enum class CsvRules { strict, lenient };

/// A table row by row: of large ones no more than a row is held.
class CsvReader {
public:
    /// Whether these cells can be the header.
    using IsHeader = std::function<bool(const std::vector<std::string>&)>;

    /// Reads the header. With `is_header` it is the first of the first 100 lines that can be one, and what stands above
    /// is left out; the first line with cells where there is none.
    CsvReader(std::string_view text, CsvRules rules, const IsHeader& is_header = {});

    /// Empty: the text has none. `line` counts from 1.
    [[nodiscard]] const CsvRow& header() const { return header_; }
    [[nodiscard]] char separator() const { return separator_; }
    /// What is wrong with the header, and there are no rows: "has ...". Empty: nothing.
    [[nodiscard]] const std::string& header_fault() const { return header_fault_; }
    /// Lines with cells above the header.
    [[nodiscard]] std::size_t lines_above() const { return lines_above_; }
    /// Texts of the comments so far, without # and the separators that a spreadsheet fills a line with.
    [[nodiscard]] const std::vector<std::string>& comments() const { return comments_; }

    /// The next row, as long as the header; false at the end. `fault` says what is wrong with it, "has ...", and is
    /// empty where nothing is.
    bool next(CsvRow& row, std::string& fault);

private:
    [[nodiscard]] char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    [[nodiscard]] bool at_line_end() const { return at_ >= text_.size() || here() == '\n' || here() == '\r'; }
    [[nodiscard]] std::string_view rest_of_line() const;
    void skip_blanks();
    void end_line();
    void skip_line();
    bool find_row();
    void find_header(const IsHeader& is_header);
    void read_row(CsvRow& row, std::string& fault);
    void read_cell(std::string& cell, std::string& fault);
    bool read_quoted(std::string& cell, std::string& fault);
    void take_header(CsvRow row);
    void fit_to_header(CsvRow& row, std::string& fault) const;

    std::string_view text_;
    CsvRules rules_;
    std::size_t at_ = 0, line_ = 1;
    char separator_ = ',';
    CsvRow header_;
    std::vector<bool> named_;  ///< by column as it is written
    std::string header_fault_;
    std::size_t lines_above_ = 0;
    std::vector<std::string> comments_;
};

/// What of the text could be understood, and one sentence for each line that could not: "line 4: ...".
struct CsvTable {
    std::vector<std::string> header;
    std::size_t header_line = 0;  ///< 0: there is none
    std::vector<CsvRow> rows;     ///< each as long as the header
    std::vector<std::string> faults;
};

/// The whole table, by strict rules.
[[nodiscard]] CsvTable parse_csv(std::string_view text);

/// Whether a file is such a table: .csv, .tsv or .tab by its name, or .txt, as spreadsheets call "Unicode text", with
/// this column in its header. Throws nothing.
[[nodiscard]] bool is_table_file(const std::filesystem::path& file, std::string_view column);

}  // namespace voxtone::io
