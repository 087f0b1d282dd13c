// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/csv_table.h"

#include <algorithm>
#include <fstream>

#include <fmt/core.h>

#include "base/counted.h"
#include "io/files/utf8.h"

namespace voxtone::io {

namespace {

constexpr std::string_view cell_blanks = " \t";

std::string_view without_blanks(std::string_view text) {
    const std::size_t first = text.find_first_not_of(cell_blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(cell_blanks) - first + 1);
}

/// Semicolons; tabs, unless each stands beside a comma and only pads; else commas.
char separator_of(std::string_view line) {
    bool quoted = false, commas = false, tabs = false, bare_tabs = false, tab_before = false;
    char last = '\0';  // but for blanks
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (!quoted && c == ';') return ';';
        if (!quoted && c == '\t') tabs = tab_before = true;
        if (c == ' ' || c == '\t') continue;
        if (!quoted && c == ',') commas = true;
        bare_tabs = bare_tabs || (tab_before && last != '\0' && last != ',' && c != ',');
        tab_before = false;
        last = c;
    }
    return bare_tabs || (tabs && !commas) ? '\t' : ',';
}

/// "sep=;", with which a spreadsheet tells another what follows; '\0': it is no such line.
char told_separator(std::string_view line) {
    if (line.starts_with('"')) line.remove_prefix(1);
    if (!line.starts_with("sep=") || line.size() < 5) return '\0';
    const char told = line[4];
    if (told != ';' && told != ',' && told != '\t') return '\0';
    return line.find_first_not_of(" \t,;\"", 5) == std::string_view::npos ? told : '\0';
}

bool is_empty_row(const CsvRow& row) {
    return std::ranges::all_of(row.cells, [](const std::string& cell) { return cell.empty(); });
}

}  // namespace

CsvReader::CsvReader(std::string_view text, CsvRules rules, const IsHeader& is_header) : text_(text), rules_(rules) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
    find_header(is_header);
}

std::string_view CsvReader::rest_of_line() const {
    return text_.substr(at_, std::min(text_.find_first_of("\r\n", at_), text_.size()) - at_);
}

void CsvReader::skip_blanks() {
    while (here() == ' ' || (here() == '\t' && separator_ != '\t')) ++at_;
}

void CsvReader::end_line() {
    if (at_ >= text_.size()) return;
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    ++line_;
}

void CsvReader::skip_line() {
    at_ += rest_of_line().size();
    end_line();
}

/// Skips what holds no cells. False at the end.
bool CsvReader::find_row() {
    for (; at_ < text_.size(); skip_line()) {
        const std::string_view line = rest_of_line();
        if (without_blanks(line).empty()) continue;
        const bool quoted = header_.cells.empty() && line.starts_with("\"#");
        if (!line.starts_with('#') && !quoted) return true;
        std::string_view comment = line.substr(line.find('#') + 1);
        const std::size_t last = comment.find_last_not_of(" \t,;\"");
        comment = comment.substr(0, last == std::string_view::npos ? 0 : last + 1);
        comments_.emplace_back(without_blanks(comment));
    }
    return false;
}

void CsvReader::find_header(const IsHeader& is_header) {
    if (!find_row()) return;
    if (const char told = told_separator(rest_of_line())) {
        skip_line();
        if (!find_row()) return;
        separator_ = told;
    } else {
        separator_ = separator_of(rest_of_line());
    }
    const std::size_t first_at = at_, first_line = line_;
    const char first_separator = separator_;
    const std::size_t first_comments = comments_.size();
    CsvRow row;
    if (is_header) {
        constexpr std::size_t most_lines_above = 100;
        for (; lines_above_ < most_lines_above && find_row(); ++lines_above_) {
            if (lines_above_ > 0) separator_ = separator_of(rest_of_line());
            const std::size_t at = at_, line = line_;
            std::string fault;
            read_row(row, fault);
            if (fault.empty() && is_header(row.cells)) return take_header(std::move(row));
            at_ = at, line_ = line;  // a row may have taken several lines, in each of which a header may begin
            skip_line();
        }
        lines_above_ = 0;
        comments_.resize(first_comments);
        at_ = first_at, line_ = first_line, separator_ = first_separator;
    }
    read_row(row, header_fault_);
    take_header(std::move(row));
}

void CsvReader::take_header(CsvRow row) {
    header_ = std::move(row);
    std::vector<std::string>& names = header_.cells;
    if (rules_ == CsvRules::lenient) {
        named_.assign(names.size(), true);
        while (!names.empty() && names.back().empty()) named_[names.size() - 1] = false, names.pop_back();
        return;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        named_.push_back(!names[i].empty());
        const auto here = names.begin() + static_cast<std::ptrdiff_t>(i);
        if (header_fault_.empty() && named_.back() && std::find(names.begin(), here, names[i]) != here)
            header_fault_ = fmt::format("the header has the column '{}' twice", names[i]);
    }
    std::erase(names, "");
}

bool CsvReader::next(CsvRow& row, std::string& fault) {
    fault.clear();
    if (!header_fault_.empty()) return false;
    while (find_row()) {
        read_row(row, fault);
        if (fault.empty() && is_empty_row(row)) continue;
        if (fault.empty()) fit_to_header(row, fault);
        return true;
    }
    return false;
}

void CsvReader::fit_to_header(CsvRow& row, std::string& fault) const {
    std::vector<std::string>& cells = row.cells;
    while (cells.size() > named_.size() && cells.back().empty()) cells.pop_back();
    if (cells.size() > named_.size() || cells.size() < header_.cells.size()) {
        fault = fmt::format("has {}, and the header has {}{}", counted(cells.size(), "cell"), header_.cells.size(),
                            separator_ == ',' ? "; a cell that holds a comma stands in quotes" : "");
        return;
    }
    if (named_.size() == header_.cells.size() && cells.size() == named_.size()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (named_[i]) {
            if (kept != i) cells[kept] = std::move(cells[i]);
            ++kept;
        } else if (!cells[i].empty() && rules_ == CsvRules::strict) {
            fault = fmt::format("has a value in column {}, which has no name in the header; name what it sets", i + 1);
            return;
        }
    }
    cells.resize(kept);
    if (kept < header_.cells.size())
        fault = fmt::format("has {}, and the header has {}", counted(kept, "cell"), header_.cells.size());
}

/// The row that begins here; what follows one with a fault is read from the next line on.
void CsvReader::read_row(CsvRow& row, std::string& fault) {
    row.line = line_;
    std::size_t count = 0;
    for (bool more = true; more; ++count) {
        if (row.cells.size() <= count) row.cells.emplace_back();
        row.cells[count].clear();
        read_cell(row.cells[count], fault);
        if (!fault.empty()) {
            row.cells.resize(count + 1);
            skip_line();
            return;
        }
        more = here() == separator_ && at_ < text_.size();
        if (more) ++at_;
    }
    row.cells.resize(count);
    end_line();
}

void CsvReader::read_cell(std::string& cell, std::string& fault) {
    const std::size_t begin = at_, begin_line = line_;
    skip_blanks();
    if (here() == '"') {
        if (read_quoted(cell, fault)) return;
        const bool never_closed = at_ >= text_.size();
        if (never_closed || rules_ == CsvRules::lenient) at_ = begin, line_ = begin_line;
        if (rules_ == CsvRules::strict) return;
        cell.clear(), fault.clear();
    }
    while (!at_line_end() && here() != separator_) {
        if (here() == '"' && rules_ == CsvRules::strict)
            fault =
                "has a quote within a cell that does not begin with one; put the whole cell in quotes and double those "
                "within";
        ++at_;
    }
    cell = without_blanks(text_.substr(begin, at_ - begin));
}

/// False where the quotes do not hold a whole cell.
bool CsvReader::read_quoted(std::string& cell, std::string& fault) {
    for (++at_;; ++at_) {
        if (at_ >= text_.size()) {
            fault = "has a cell whose quote is never closed";
            return false;
        }
        if (here() == '"') {
            if (!text_.substr(at_ + 1).starts_with('"')) break;
            ++at_;
        } else if (at_line_end()) {
            if (text_.substr(at_).starts_with("\r\n")) ++at_;
            ++line_;
            cell += '\n';
            continue;
        }
        cell += here();
    }
    ++at_;
    skip_blanks();
    if (at_line_end() || here() == separator_) return true;
    fault = "has text behind a closing quote; double the quotes within a cell";
    return false;
}

CsvTable parse_csv(std::string_view text) {
    CsvTable table;
    CsvReader reader(text, CsvRules::strict);
    const auto blame = [&](std::size_t line, const std::string& what) {
        table.faults.push_back(fmt::format("line {}: {}", line, what));
    };
    if (!reader.header_fault().empty()) {
        blame(reader.header().line, reader.header_fault());
        return table;
    }
    table.header = reader.header().cells;
    table.header_line = reader.header().line;
    CsvRow row;
    for (std::string fault; reader.next(row, fault);) {
        if (fault.empty())
            table.rows.push_back(row);
        else
            blame(row.line, fault);
    }
    return table;
}

bool is_table_file(const std::filesystem::path& file, std::string_view column) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (extension == ".csv" || extension == ".tsv" || extension == ".tab") return true;
    if (extension != ".txt") return false;
    constexpr std::size_t head_bytes = std::size_t{1} << 16;
    std::string head(head_bytes, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
    const std::string text = text_as_utf8(head);
    const CsvReader reader(text, CsvRules::strict);
    const std::vector<std::string>& names = reader.header().cells;
    return reader.header_fault().empty() && std::ranges::find(names, column) != names.end();
}

}  // namespace voxtone::io
