// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/cgats_file.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/chart_columns.h"
#include "calibration/patches/table_cells.h"

namespace voxtone::calibration {

namespace {

using Words = std::vector<std::string_view>;

// What such files call themselves in their first line.
constexpr std::string_view relatives[] = {"CGATS", "CTI", "IT8", "ISO28178"};

bool is_blank(char c) { return c == ' ' || c == '\t'; }

// Words of a line; a comment ends it.
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
        const std::size_t to = std::min(quoted ? line.find('"', from) : line.find_first_of(" \t", from), line.size());
        words.push_back(line.substr(from, to - from));
        at = quoted ? to + 1 : to;
    }
    return words;
}

class CgatsReader {
public:
    CgatsReader(std::string_view text, const std::string& source) : text_(text), source_(source) {}

    ChartReading read() {
        for (Words words; next_line(words);) {
            if (words.empty()) continue;
            const std::string key = in_capitals(words[0]);
            if (key == "BEGIN_DATA_FORMAT") {
                read_format(Words(words.begin() + 1, words.end()));
            } else if (key == "BEGIN_DATA") {
                if (read_data()) return std::move(reading_);
            } else {
                keyword(key, words);
            }
        }
        if (!fault_.empty()) throw InputError(fault_);
        throw InputError(
            fmt::format("{}: has no BEGIN_DATA, so that it holds no measurement or is cut short; export "
                        "it again.",
                        source_));
    }

private:
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
        words = words_of(text_of_line_);
        return true;
    }

    void keyword(const std::string& key, const Words& words) {
        if (words.size() < 2) return;
        if (key == "NUMBER_OF_FIELDS") number_of_fields_ = number(words[1]);
        if (key == "NUMBER_OF_SETS") number_of_sets_ = number(words[1]);
        note_condition(conditions_, key, words[1]);
    }

    void read_format(Words words) {
        fields_.clear();
        format_line_ = line_;
        do {
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

    // Reads a table, and says whether it is the one that is looked for.
    bool read_data() {
        if (fields_.empty()) fail("BEGIN_DATA, but no BEGIN_DATA_FORMAT said what its columns are");
        std::optional<ChartColumns> columns;
        try {
            columns = chart_columns(fields_, fmt::format("{}: line {}", source_, format_line_));
        } catch (const InputError& error) {
            if (fault_.empty()) fault_ = error.what();
        }
        reading_.table.source = source_;
        std::size_t rows = 0;
        Words row;
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
                if (columns) finish(*columns);
                return columns.has_value();
            }
            if (!complete(row, words)) continue;
            if (++rows > most_chart_patches) fail(fmt::format("more than {} patches", most_chart_patches));
            if (columns) reading_.table.patches.push_back(chart_row(*columns, row, where()));
            row.clear();
        }
        fail("is cut short: BEGIN_DATA has no END_DATA; export it again");
    }

    // Adds a line to a row that may have begun before.
    bool complete(Words& row, const Words& words) const {
        if (row.empty() && words.size() != fields_.size()) {
            // Programs that separate by tabs leave an empty value empty.
            Words cells = split_quoted(text_of_line_, '\t');
            if (cells.size() == fields_.size() + 1 && cells.back().empty()) cells.pop_back();
            if (cells.size() == fields_.size()) {
                row = std::move(cells);
                return true;
            }
        }
        row.insert(row.end(), words.begin(), words.end());
        if (row.size() > fields_.size())
            fail(fmt::format("a row of {} values, but the format has {} fields", row.size(), fields_.size()));
        return row.size() == fields_.size();
    }

    void finish(const ChartColumns& columns) {
        reading_.quantity = columns.quantity;
        reading_.rest_is_white = columns.rest_is_white;
        reading_.conditions = conditions_;
        if (columns.quantity == Quantity::spectrum) reading_.table.channels.wavelengths_nm = columns.wavelengths_nm;
        if (!columns.note.empty()) reading_.table.notes.push_back(fmt::format("{}: {}.", source_, columns.note));
    }

    std::string_view text_, text_of_line_;
    std::string source_;
    std::size_t at_ = 0, line_ = 0, format_line_ = 0;
    std::optional<double> number_of_fields_, number_of_sets_;
    MeasuringConditions conditions_;
    Words fields_;
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
        const std::string key = in_capitals(words[0]);
        if (first && words.size() == 1 &&
            std::ranges::any_of(relatives, [&](std::string_view name) { return key.starts_with(name); }))
            return true;
        first = false;
        if (key == "BEGIN_DATA_FORMAT" || key == "BEGIN_DATA") return true;
    }
    return false;
}

ChartReading read_cgats(std::string_view text, const std::string& source) { return CgatsReader(text, source).read(); }

}  // namespace voxtone::calibration
