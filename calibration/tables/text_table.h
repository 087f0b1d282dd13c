// SPDX-License-Identifier: GPL-3.0-or-later
//
// A table of text as people, spreadsheets and instruments write it, whatever its format: names of columns, then rows of
// as many cells. Who reads one says what is wrong with it, the table says where:
//
//   FILE: line 4, column 3 ("x_mm"): "a" is no number.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/csv_table.h"

namespace voxtone::calibration {

/// Row by row: of large ones no more than a row is held.
class TextTable {
public:
    virtual ~TextTable() = default;

    [[nodiscard]] const std::string& source() const { return source_; }
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    /// The next row; false behind the last. Throws InputError where it is not as long as the header.
    virtual bool next() = 0;
    /// Of the row, as many as names.
    [[nodiscard]] const std::vector<std::string>& cells() const { return cells_; }
    /// A cell as a number with a decimal point or comma. Throws InputError.
    [[nodiscard]] double number(std::size_t column) const;
    /// What the text says beside the table, as far as it is read: keywords, and comments such as "illuminant: D65".
    [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& words() const { return words_; }

    /// "FILE: line 4": the row, or the header before the first.
    [[nodiscard]] std::string where() const;
    [[noreturn]] void fail(std::string_view what) const;
    [[noreturn]] void fail(std::size_t column, std::string_view what) const;
    /// Throws InputError that shows `example` unless the header begins with these names.
    void expect_names(std::span<const std::string_view> first, std::string_view example) const;

protected:
    explicit TextTable(std::string source) : source_(std::move(source)) {}
    TextTable(const TextTable&) = default;
    TextTable& operator=(const TextTable&) = default;

    std::string source_, title_;  ///< title: of one table of several in a file
    std::size_t line_ = 0;
    std::vector<std::string> names_, cells_;
    std::vector<std::pair<std::string, std::string>> words_;
};

/// A table whose cells stand between commas, semicolons or tabs (io/files/csv_table.h, lenient rules).
class CsvText : public TextTable {
public:
    enum class ShortRows { refused, filled };

    /// `text` outlives it. Throws InputError where there is no header line; `example` tells what one looks like.
    CsvText(std::string_view text, std::string source, std::string_view example,
            const io::CsvReader::IsHeader& is_header = {}, ShortRows short_rows = ShortRows::refused);

    bool next() override;
    /// Lines with cells above the header.
    [[nodiscard]] std::size_t lines_above() const { return csv_.lines_above(); }

private:
    void take_comments();

    io::CsvReader csv_;
    ShortRows short_rows_;
    io::CsvRow row_;
    std::size_t comments_ = 0;
};

/// A whole file as UTF-8 (io/files/utf8.h). Throws FileError.
[[nodiscard]] std::string read_text(const std::filesystem::path& file, std::uint64_t most_bytes);

}  // namespace voxtone::calibration
