// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/cgats_file.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/chart_columns.h"
#include "calibration/patches/device_curves.h"
#include "calibration/patches/table_cells.h"

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

// Without the separators that a spreadsheet fills a line with.
std::string_view without_filling(std::string_view word) {
    while (!word.empty() && (word.back() == ',' || word.back() == ';')) word.remove_suffix(1);
    return word;
}

// What separates cells where a spreadsheet has saved the text as a table; '\0': none has.
char separator_of_cells(std::string_view text) {
    constexpr std::string_view begin = "BEGIN_DATA_FORMAT";
    const std::size_t at = text.find(begin);
    if (at == std::string_view::npos || at + begin.size() >= text.size()) return '\0';
    const char next = text[at + begin.size()];
    return next == ',' || next == ';' ? next : '\0';
}

class CgatsReader {
public:
    CgatsReader(std::string_view text, const std::string& source, const ColumnWords& words)
        : text_(text), source_(source), known_words_(words), separator_(separator_of_cells(text)) {}

    ChartReading read() {
        for (Words words; next_line(words);) {
            if (words.empty()) continue;
            const std::string key = in_capitals(words[0]);
            const bool wanted = !found_ || kind_ == calibration_kind;  // what else follows is not looked at
            if (key == "BEGIN_DATA_FORMAT" && wanted)
                read_format(Words(words.begin() + 1, words.end()));
            else if (key == "BEGIN_DATA" && wanted)
                read_data();
            else
                keyword(key, words);
        }
        if (found_) {
            curves_.apply(reading_);
            return std::move(reading_);
        }
        if (!fault_.empty()) throw InputError(fault_);
        if (!curves_.empty())
            throw InputError(
                fmt::format("{}: holds the curves of a printer's calibration (CAL) and no measurement; give the chart "
                            "that was measured (.ti3).",
                            source_));
        throw InputError(
            fmt::format("{}: has no BEGIN_DATA, so that it holds no measurement or is cut short; export "
                        "it again.",
                        source_));
    }

private:
    static constexpr std::string_view calibration_kind = "CAL";

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: line {}: {}.", source_, line_, what));
    }
    std::string where() const { return fmt::format("{}: line {}", source_, line_); }

    bool next_line(Words& words) {
        if (at_ >= text_.size()) return false;
        const std::size_t to = std::min(text_.find_first_of("\r\n", at_), text_.size());
        text_of_line_ = text_.substr(at_, to - at_);
        at_ = to + (text_.substr(to).starts_with("\r\n") ? 2 : 1);
        ++line_;
        words = separator_ == '\0' ? words_of(text_of_line_) : words_of_cells();
        if (!in_data_ && words.size() == 1 && words[0].find_first_of(" \t") != std::string_view::npos) {
            // A spreadsheet takes a line with quotes in it for one cell.
            unquoted_line_ = with_single_quotes(words[0]);
            words = words_of(unquoted_line_);
        }
        return true;
    }

    Words words_of_cells() const {
        if (trimmed(text_of_line_).starts_with('#')) return {};
        Words cells = split_quoted(text_of_line_, separator_);
        while (!cells.empty() && cells.back().empty()) cells.pop_back();
        return cells.size() == 1 && !text_of_line_.starts_with('"') ? words_of(cells[0]) : cells;
    }

    void keyword(const std::string& key, const Words& words) {
        if (words.size() == 1 && (key == calibration_kind || is_relative(key))) kind_ = key;
        if (words.size() < 2) return;
        if (key == "NUMBER_OF_FIELDS") number_of_fields_ = number(words[1]);
        if (key == "NUMBER_OF_SETS") number_of_sets_ = number(words[1]);
        if (key == "COLOR_REP") device_ = words[1].substr(0, words[1].find('_'));
        note_condition(conditions_, key, with_single_quotes(words[1]));
    }

    void read_format(Words words) {
        fields_.clear();
        format_line_ = line_;
        do {
            // Names with blanks, where programs separate by tabs.
            const Words cells = split_quoted(text_of_line_, '\t');
            const auto is_whole = [&](const Words& list) {
                return number_of_fields_ == static_cast<double>(list.size());
            };
            if (line_ > format_line_ && !is_whole(words) && is_whole(cells)) words = cells;
            for (const std::string_view word : words) {
                if (in_capitals(word) == "END_DATA_FORMAT") {
                    if (number_of_fields_ && *number_of_fields_ != static_cast<double>(fields_.size()))
                        fail(fmt::format("NUMBER_OF_FIELDS is {}, but {} fields are listed; export it again",
                                         *number_of_fields_, fields_.size()));
                    return;
                }
                fields_.push_back(word);
            }
        } while (next_line(words));
        fail("is cut short: BEGIN_DATA_FORMAT has no END_DATA_FORMAT; export it again");
    }

    void refuse_expected_colours() const {
        if (kind_.starts_with("CTI1") || kind_.starts_with("CTI2"))
            fail(fmt::format(
                "is a chart of Argyll's that is to be printed ({}): its colours are what is expected of it, "
                "and nobody has measured them; print it, measure it, and give the .ti3",
                kind_.starts_with("CTI1") ? "CTI1, a .ti1" : "CTI2, a .ti2"));
    }

    // Reads a table: the chart that is looked for, the curves of a calibration, or one that is neither.
    void read_data() {
        if (fields_.empty()) fail("BEGIN_DATA, but no BEGIN_DATA_FORMAT said what its columns are");
        refuse_expected_colours();
        if (kind_ == calibration_kind) return read_curves();
        std::optional<ChartColumns> columns;
        try {
            ColumnWords words = known_words_;
            words.device = device_;
            columns = chart_columns(fields_, fmt::format("{}: line {}", source_, format_line_), words);
        } catch (const InputError& error) {
            if (fault_.empty()) fault_ = error.what();
        }
        reading_.table.source = source_;
        read_rows([&](const Words& row) {
            if (columns) reading_.table.patches.push_back(chart_row(*columns, row, where()));
        });
        if (!columns) return;
        reading_.conditions = conditions_;
        put_columns_in(*columns, reading_);
        found_ = true;
    }

    void read_curves() {
        curves_ = DeviceCurves(fields_, where());
        read_rows([&](const Words& row) { curves_.add(row, where()); });
    }

    template <class Take>
    void read_rows(Take take) {
        std::size_t rows = 0;
        Words row;
        in_data_ = true;
        for (Words words; next_line(words);) {
            if (words.empty()) continue;
            if (words.size() == 1 && in_capitals(words[0]) == "END_DATA") {
                if (!row.empty())
                    fail(fmt::format("the last row has {} values, but the format has {} fields", row.size(),
                                     fields_.size()));
                if (number_of_sets_ && *number_of_sets_ != static_cast<double>(rows))
                    fail(fmt::format("NUMBER_OF_SETS is {}, but there are {} rows; export it again", *number_of_sets_,
                                     rows));
                number_of_fields_.reset(), number_of_sets_.reset();
                in_data_ = false;
                return;
            }
            if (!complete(row, words)) continue;
            if (++rows > most_chart_patches) fail(fmt::format("more than {} patches", most_chart_patches));
            take(row);
            row.clear();
        }
        fail("is cut short: BEGIN_DATA has no END_DATA; export it again");
    }

    // Adds a line to a row that may have begun before.
    bool complete(Words& row, const Words& words) const {
        if (row.empty() && words.size() != fields_.size()) {
            // Programs that separate by tabs, and spreadsheets, leave an empty value empty.
            const char separator = separator_ == '\0' ? '\t' : separator_;
            // The latter where a quote is an inch.
            for (Words cells : {split_quoted(text_of_line_, separator), split(text_of_line_, separator)}) {
                while (cells.size() > fields_.size() && cells.back().empty()) cells.pop_back();
                if (cells.size() != fields_.size()) continue;
                row = std::move(cells);
                return true;
            }
        }
        row.insert(row.end(), words.begin(), words.end());
        if (row.size() > fields_.size())
            fail(fmt::format("a row of {} values, but the format has {} fields", row.size(), fields_.size()));
        return row.size() == fields_.size();
    }

    static bool is_relative(std::string_view key) {
        return std::ranges::any_of(relatives, [&](std::string_view name) { return key.starts_with(name); });
    }

    std::string_view text_, text_of_line_;
    std::string source_;
    ColumnWords known_words_;
    char separator_;
    std::string unquoted_line_, kind_, device_;
    bool in_data_ = false, found_ = false;
    std::size_t at_ = 0, line_ = 0, format_line_ = 0;
    std::optional<double> number_of_fields_, number_of_sets_;
    MeasuringConditions conditions_;
    Words fields_;
    DeviceCurves curves_;
    std::string fault_;  // of the first table that cannot be used
    ChartReading reading_;
};

}  // namespace

bool is_cgats(std::string_view text) {
    constexpr std::size_t longest_head = std::size_t{1} << 20;
    text = text.substr(0, longest_head);
    bool first = true;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t to = std::min(text.find_first_of("\r\n", at), text.size());
        const Words words = words_of(text.substr(at, to - at));
        at = to + 1;
        if (words.empty()) continue;
        const std::string key = in_capitals(without_filling(words[0]));
        if (first && words.size() == 1 &&
            std::ranges::any_of(relatives, [&](std::string_view name) { return key.starts_with(name); }))
            return true;
        first = false;
        if (key == "BEGIN_DATA_FORMAT" || key == "BEGIN_DATA") return true;
    }
    return false;
}

ChartReading read_cgats(std::string_view text, const std::string& source, const ColumnWords& words) {
    return CgatsReader(text, source, words).read();
}

}  // namespace voxtone::calibration
