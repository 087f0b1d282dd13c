// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/tables/cgats_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

namespace {

using Words = std::vector<std::string_view>;

// What such files call themselves in their first line.
constexpr std::string_view relatives[] = {"CGATS", "CTI", "IT8", "ISO28178"};

bool is_blank(char c) { return c == ' ' || c == '\t'; }

// Where a quoted word ends that begins at `from`: two quotes within are one of its own.
std::size_t end_of_quoted(std::string_view line, std::size_t from) {
    for (std::size_t i = from; i < line.size(); ++i) {
        if (line[i] != '"') continue;
        if (i + 1 >= line.size() || line[i + 1] != '"') return i;
        ++i;
    }
    return line.size();
}

// Words of a line, quotes within them still doubled; a comment ends it.
Words words_of(std::string_view line) {
    Words words;
    for (std::size_t at = 0; at < line.size();) {
        if (is_blank(line[at])) {
            ++at;
            continue;
        }
        if (line[at] == '#') break;
        const bool quoted = line[at] == '"';
        const std::size_t from = quoted ? at + 1 : at;
        const std::size_t to =
            quoted ? end_of_quoted(line, from) : std::min(line.find_first_of(" \t", from), line.size());
        words.push_back(line.substr(from, to - from));
        at = quoted ? to + 1 : to;
    }
    return words;
}

std::string with_single_quotes(std::string_view word) {
    std::string text;
    for (std::size_t i = 0; i < word.size(); ++i) {
        text += word[i];
        if (word[i] == '"' && i + 1 < word.size() && word[i + 1] == '"') ++i;
    }
    return text;
}

// What separates cells where a spreadsheet has saved the text as a table; '\0': none has.
char separator_of_cells(std::string_view text) {
    constexpr std::string_view begin = "BEGIN_DATA_FORMAT";
    const std::size_t at = text.find(begin);
    if (at == std::string_view::npos || at + begin.size() >= text.size()) return '\0';
    const char next = text[at + begin.size()];
    return next == ',' || next == ';' ? next : '\0';
}

bool names_kind(const std::string& key) {
    return key == "CAL" || std::ranges::any_of(relatives, [&](std::string_view name) { return key.starts_with(name); });
}

}  // namespace

CgatsText::CgatsText(std::string_view text, std::string source)
    : TextTable(std::move(source)), text_(text), separator_(separator_of_cells(text)) {}

bool CgatsText::is(std::string_view text) {
    constexpr std::size_t longest_head = std::size_t{1} << 20;
    CgatsText head(text.substr(0, longest_head), {});
    bool first = true;
    for (Words words; head.next_line(words);) {
        if (words.empty()) continue;
        const std::string key = in_capitals(words[0]);
        if ((first && words.size() == 1 && key != "CAL" && names_kind(key)) || key == "BEGIN_DATA_FORMAT" ||
            key == "BEGIN_DATA")
            return true;
        first = false;
    }
    return false;
}

bool CgatsText::next_table(std::string_view of_kind) {
    in_rows_ = false;
    for (Words words; next_line(words);) {
        if (words.empty()) continue;
        const std::string key = in_capitals(words[0]);
        const bool wanted = of_kind.empty() || kind_ == of_kind;
        if (key == "BEGIN_DATA_FORMAT" && wanted) {
            read_format(Words(words.begin() + 1, words.end()));
        } else if (key == "BEGIN_DATA" && wanted) {
            if (names_.empty()) {
                line_ = last_line_;
                fail("BEGIN_DATA, but no BEGIN_DATA_FORMAT said what its columns are");
            }
            in_rows_ = true, rows_ = 0;
            return true;
        } else {
            keyword(key, words);
        }
    }
    return false;
}

bool CgatsText::next_line(Words& words) {
    if (at_ >= text_.size()) return false;
    const std::size_t to = std::min(text_.find_first_of("\r\n", at_), text_.size());
    text_of_line_ = text_.substr(at_, to - at_);
    at_ = to + (text_.substr(to).starts_with("\r\n") ? 2 : 1);
    ++last_line_;
    words = separator_ == '\0' ? words_of(text_of_line_) : words_of_cells();
    if (!in_rows_ && words.size() == 1 && words[0].find_first_of(" \t") != std::string_view::npos) {
        // A spreadsheet takes a line with quotes in it for one cell.
        unquoted_line_ = with_single_quotes(words[0]);
        words = words_of(unquoted_line_);
    }
    return true;
}

CgatsText::Words CgatsText::words_of_cells() const {
    if (trimmed(text_of_line_).starts_with('#')) return {};
    Words cells = split_quoted(text_of_line_, separator_);
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    return cells.size() == 1 && !text_of_line_.starts_with('"') ? words_of(cells[0]) : cells;
}

void CgatsText::keyword(const std::string& key, const Words& words) {
    if (words.size() == 1 && names_kind(key)) {
        kind_ = key;
        title_ = kind_ == "CAL" ? "its CAL table" : "";
    }
    if (words.size() < 2) return;
    if (key == "NUMBER_OF_FIELDS") number_of_fields_ = calibration::number(words[1]);
    if (key == "NUMBER_OF_SETS") number_of_sets_ = calibration::number(words[1]);
    if (key == "COLOR_REP") device_ = words[1].substr(0, words[1].find('_'));
    words_.emplace_back(key, with_single_quotes(words[1]));
}

void CgatsText::read_format(Words words) {
    names_.clear();
    line_ = last_line_;
    do {
        // Names with blanks, where programs separate by tabs.
        const Words cells = split_quoted(text_of_line_, '\t');
        const auto is_whole = [&](const Words& list) { return number_of_fields_ == static_cast<double>(list.size()); };
        if (last_line_ > line_ && !is_whole(words) && is_whole(cells)) words = cells;
        for (const std::string_view word : words) {
            if (in_capitals(word) == "END_DATA_FORMAT") {
                if (number_of_fields_ && *number_of_fields_ != static_cast<double>(names_.size()))
                    fail(fmt::format("NUMBER_OF_FIELDS is {}, but {} fields are listed; export it again",
                                     *number_of_fields_, names_.size()));
                return;
            }
            names_.emplace_back(word);
        }
    } while (next_line(words));
    fail("is cut short: BEGIN_DATA_FORMAT has no END_DATA_FORMAT; export it again");
}

bool CgatsText::next() {
    Words row;
    for (Words words; next_line(words);) {
        if (words.empty()) continue;
        line_ = last_line_;
        if (words.size() == 1 && in_capitals(words[0]) == "END_DATA") {
            if (!row.empty())
                fail(
                    fmt::format("the last row has {} values, but the format has {} fields", row.size(), names_.size()));
            expect_number_of_sets();
            return false;
        }
        if (!complete(row, words)) continue;
        cells_.resize(row.size());
        std::ranges::transform(row, cells_.begin(), with_single_quotes);
        ++rows_;
        return true;
    }
    line_ = last_line_;
    fail("is cut short: BEGIN_DATA has no END_DATA; export it again");
}

void CgatsText::expect_number_of_sets() {
    if (number_of_sets_ && *number_of_sets_ != static_cast<double>(rows_))
        fail(fmt::format("NUMBER_OF_SETS is {}, but there are {} rows; export it again", *number_of_sets_, rows_));
    number_of_fields_.reset(), number_of_sets_.reset();
    in_rows_ = false;
}

// Adds a line to a row that may have begun before.
bool CgatsText::complete(Words& row, const Words& words) const {
    if (row.empty() && words.size() != names_.size()) {
        // Programs that separate by tabs, and spreadsheets, leave an empty value empty.
        const char separator = separator_ == '\0' ? '\t' : separator_;
        // The latter where a quote is an inch.
        for (Words cells : {split_quoted(text_of_line_, separator), split(text_of_line_, separator)}) {
            while (cells.size() > names_.size() && cells.back().empty()) cells.pop_back();
            if (cells.size() != names_.size()) continue;
            row = std::move(cells);
            return true;
        }
    }
    row.insert(row.end(), words.begin(), words.end());
    if (row.size() > names_.size())
        fail(fmt::format("a row of {} values, but the format has {} fields", row.size(), names_.size()));
    return row.size() == names_.size();
}

}  // namespace voxtone::calibration
