// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/tables/text_table.h"

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/tables/table_cells.h"
#include "io/files/utf8.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {

double TextTable::number(std::size_t column) const {
    const auto value = number_with_comma(cells_[column]);
    if (!value) fail(column, fmt::format("{} is no number", shown(cells_[column])));
    return *value;
}

std::string TextTable::where() const {
    return fmt::format("{}: {}{}line {}", source_, title_, title_.empty() ? "" : ": ", line_);
}

void TextTable::fail(std::string_view what) const { throw InputError(fmt::format("{}: {}.", where(), what)); }

void TextTable::fail(std::size_t column, std::string_view what) const {
    throw InputError(fmt::format("{}, column {} ({}): {}.", where(), column + 1, shown(names_[column]), what));
}

void TextTable::expect_names(std::span<const std::string_view> first, std::string_view example) const {
    for (std::size_t k = 0; k < first.size(); ++k)
        if (k >= names_.size() || names_[k] != first[k])
            fail(fmt::format("column {} is {}, expected \"{}\": the header is {}", k + 1,
                             k < names_.size() ? shown(names_[k]) : "missing", first[k], example));
}

CsvText::CsvText(std::string_view text, std::string source, std::string_view example,
                 const io::CsvReader::IsHeader& is_header, ShortRows short_rows)
    : TextTable(std::move(source)), csv_(text, io::CsvRules::lenient, is_header), short_rows_(short_rows) {
    line_ = csv_.header().line;
    names_ = csv_.header().cells;
    if (names_.empty()) throw InputError(fmt::format("{}: has no header line; {}.", source_, example));
    take_comments();
}

bool CsvText::next() {
    std::string fault;
    const bool more = csv_.next(row_, fault);
    take_comments();
    if (!more) return false;
    line_ = row_.line;
    std::swap(cells_, row_.cells);
    if (short_rows_ == ShortRows::filled && cells_.size() < names_.size()) {
        cells_.resize(names_.size());
        return true;
    }
    if (!fault.empty()) fail(fault);
    return true;
}

void CsvText::take_comments() {
    for (; comments_ < csv_.comments().size(); ++comments_) {
        const std::string& comment = csv_.comments()[comments_];
        if (const std::size_t colon = comment.find(':'); colon != std::string::npos)
            words_.emplace_back(comment.substr(0, colon), comment.substr(colon + 1));
    }
}

std::string read_text(const std::filesystem::path& file, std::uint64_t most_bytes) {
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file, most_bytes);
    return io::text_as_utf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace voxtone::calibration
