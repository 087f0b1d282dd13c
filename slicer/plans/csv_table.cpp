// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/csv_table.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/counted.h"

namespace voxtone::slicer {

namespace {

std::string trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

/// Takes a text apart, row by row.
class CsvReader {
public:
    explicit CsvReader(std::string_view text) : text_(text) {
        constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
        if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
    }

    [[nodiscard]] bool at_end() const { return at_ == text_.size(); }

    /// Skips what holds no cells. False at the end.
    bool find_row() {
        while (!at_end()) {
            const std::string_view rest = text_.substr(at_, text_.find('\n', at_) - at_);
            const std::size_t first = rest.find_first_not_of(" \t\r");
            if (first != std::string_view::npos && rest[0] != '#') return true;
            skip_line();
        }
        return false;
    }

    /// The row that begins here; `fault` says what is wrong with it, and what follows is read from the next line on.
    CsvRow read_row(std::string& fault) {
        CsvRow row{line_, {}};
        do {
            row.cells.push_back(read_cell(fault));
            if (!fault.empty()) {
                skip_line();
                return row;
            }
        } while (take(','));
        take('\r');
        take('\n');
        return row;
    }

private:
    [[nodiscard]] char next() const { return at_end() ? '\0' : text_[at_]; }
    [[nodiscard]] bool at_line_end() const { return at_end() || next() == '\n' || text_.substr(at_, 2) == "\r\n"; }

    bool take(char c) {
        if (at_end() || next() != c) return false;
        line_ += c == '\n';
        ++at_;
        return true;
    }

    void skip_line() {
        while (!at_end() && !take('\n')) ++at_;
    }

    std::string read_cell(std::string& fault) {
        const std::size_t begin = at_;
        while (next() == ' ' || next() == '\t') ++at_;
        if (next() == '"') return read_quoted(fault);
        while (!at_line_end() && next() != ',') {
            if (next() == '"')
                fault =
                    "has a quote within a cell that does not begin with one; put the whole cell in quotes and "
                    "double those within";
            ++at_;
        }
        return trimmed(text_.substr(begin, at_ - begin));
    }

    std::string read_quoted(std::string& fault) {
        const std::size_t begin = at_++, begin_line = line_;
        std::string cell;
        for (;;) {
            if (at_end()) {
                fault = "has a cell whose quote is never closed";
                at_ = begin + 1;  // what follows is read as if the quote were not there
                line_ = begin_line;
                return cell;
            }
            if (take('"')) {
                if (!take('"')) break;
                cell += '"';
                continue;
            }
            cell += next();
            take(next());
        }
        while (next() == ' ' || next() == '\t') ++at_;
        if (!at_line_end() && next() != ',') fault = "has text behind a closing quote; double the quotes within a cell";
        return cell;
    }

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

std::string header_fault(const std::vector<std::string>& header) {
    if (header.size() == 1)
        for (const char other : {';', '\t'})
            if (header[0].find(other) != std::string::npos)
                return fmt::format("cells are set apart by {} here and not by commas; export it with commas",
                                   other == ';' ? "semicolons" : "tabs");
    for (std::size_t i = 0; i < header.size(); ++i) {
        if (header[i].empty())
            return fmt::format("column {} of the header has no name; name the option that it sets", i + 1);
        if (std::find(header.begin(), header.begin() + std::ptrdiff_t(i), header[i]) !=
            header.begin() + std::ptrdiff_t(i))
            return fmt::format("the header has the column '{}' twice", header[i]);
    }
    return {};
}

}  // namespace

CsvTable parse_csv(std::string_view text) {
    CsvTable table;
    CsvReader reader(text);
    const auto blame = [&](std::size_t line, const std::string& what) {
        table.faults.push_back(fmt::format("line {}: {}", line, what));
    };
    while (reader.find_row()) {
        std::string fault;
        CsvRow row = reader.read_row(fault);
        if (table.header.empty()) {
            if (fault.empty()) fault = header_fault(row.cells);
            if (!fault.empty()) {
                blame(row.line, fault);
                return table;
            }
            table.header = std::move(row.cells);
        } else if (!fault.empty()) {
            blame(row.line, fault);
        } else if (row.cells.size() != table.header.size()) {
            blame(row.line, fmt::format("has {}, and the header has {}; a cell that holds a comma stands in quotes",
                                        counted(row.cells.size(), "cell"), table.header.size()));
        } else {
            table.rows.push_back(std::move(row));
        }
    }
    return table;
}

}  // namespace voxtone::slicer
