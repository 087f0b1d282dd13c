// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_csv.h"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/contracts.h"
#include "base/error.h"
#include "calibration/patches/chart_columns.h"
#include "calibration/patches/table_cells.h"

namespace voxtone::calibration {

namespace {

char separator_of(std::string_view header) {
    if (header.find(';') != std::string_view::npos) return ';';
    return header.find('\t') != std::string_view::npos ? '\t' : ',';
}

class ChartCsvReader {
public:
    ChartCsvReader(std::string_view text, const std::string& source) : text_(text) { reading_.table.source = source; }

    ChartReading read() {
        for (std::size_t from = 0; from < text_.size();) {
            // A file of old programs ends its lines with CR alone; a pair of CR and LF makes an empty line between.
            const std::size_t to = std::min(text_.find_first_of("\r\n", from), text_.size());
            const std::string_view line = text_.substr(from, to - from);
            from = to + (text_.substr(to).starts_with("\r\n") ? 2 : 1);
            ++line_;
            if (trimmed(line).starts_with('#'))
                comment(trimmed(line).substr(1));
            else if (!columns_)
                header(line);
            else
                row(line);
        }
        if (!columns_)
            throw InputError(fmt::format(
                "{}: has no header line; a chart begins with a line such as W,C,M,Y,K,L,a,b, and a target with "
                "top,backing,thickness_mm,R,G,B.",
                reading_.table.source));
        if (unmeasured_ > 0 && reading_.table.patches.empty())
            throw InputError(fmt::format("{}: no patch is measured yet: its {} lines have no colour; fill them in.",
                                         reading_.table.source, unmeasured_));
        if (unmeasured_ > 0)
            reading_.table.notes.push_back(
                fmt::format("{}: {} patches have no colour and are left out.", reading_.table.source, unmeasured_));
        return std::move(reading_);
    }

private:
    std::string where() const { return fmt::format("{}: line {}", reading_.table.source, line_); }

    void comment(std::string_view text) {
        const std::size_t colon = text.find(':');
        if (colon != std::string_view::npos)
            note_condition(reading_.conditions, text.substr(0, colon), text.substr(colon + 1));
    }

    void header(std::string_view line) {
        if (trimmed(line).empty()) return;
        separator_ = separator_of(line);
        columns_ = chart_columns(split_quoted(line, separator_), where());
        reading_.quantity = columns_->quantity;
        reading_.rest_is_white = columns_->rest_is_white;
        if (columns_->quantity == Quantity::spectrum) reading_.table.channels.wavelengths_nm = columns_->wavelengths_nm;
        if (!columns_->note.empty())
            reading_.table.notes.push_back(fmt::format("{}: {}.", reading_.table.source, columns_->note));
    }

    void row(std::string_view line) {
        // Spreadsheets leave lines of separators behind.
        if (line.find_first_not_of(" ,;\t\r") == std::string_view::npos) return;
        if (reading_.table.patches.size() >= most_chart_patches)
            throw InputError(fmt::format("{}: more than {} patches.", where(), most_chart_patches));
        const auto cells = split_quoted(line, separator_);
        if (cells.size() != columns_->columns.size())
            throw InputError(fmt::format("{}: {} cells, but the header has {}; every patch needs them all.", where(),
                                         cells.size(), columns_->columns.size()));
        if (is_unmeasured(*columns_, cells)) {
            ++unmeasured_;
            return;
        }
        reading_.table.patches.push_back(chart_row(*columns_, cells, where()));
    }

    std::string_view text_;
    ChartReading reading_;
    std::optional<ChartColumns> columns_;
    char separator_ = ',';
    std::size_t line_ = 0, unmeasured_ = 0;
};

// Roles in the order in which they come; white first, as people write it.
std::vector<std::string> roles_of(const PatchTable& table) {
    std::vector<std::string> roles;
    for (const Patch& patch : table.patches)
        for (const ResinShare& share : patch.top)
            if (std::ranges::find(roles, share.role) == roles.end()) roles.push_back(share.role);
    std::stable_partition(roles.begin(), roles.end(), [](const std::string& role) { return role == "W"; });
    return roles;
}

}  // namespace

ChartReading read_chart_csv(std::string_view text, const std::string& source) {
    return ChartCsvReader(text, source).read();
}

std::string chart_csv_text(const PatchTable& table, std::string_view comment) {
    VOXTONE_EXPECT(table.is_chart);
    const auto& patches = table.patches;
    const bool layered = std::ranges::any_of(patches, [](const Patch& p) { return p.thickness_mm > 0; });
    const bool based = std::ranges::any_of(patches, [](const Patch& p) { return p.base_mm > 0; });
    const bool errors =
        !patches.empty() && std::ranges::all_of(patches, [](const Patch& p) { return !p.error.empty(); });
    const std::vector<std::string> roles = roles_of(table);
    std::string text = comment_lines(comment) + comment_lines(written_illuminant(table.channels));
    text += fmt::format("{}", fmt::join(roles, ","));
    if (layered) text += ",thickness_mm,backing";
    if (based) text += ",base_mm";
    text += fmt::format(",{}\n", fmt::join(written_names(table.channels, errors), ","));
    for (const Patch& patch : patches) {
        std::map<std::string, double> shares;
        for (const ResinShare& share : patch.top) shares[share.role] = share.fraction;
        std::vector<double> row;
        for (const std::string& role : roles) row.push_back(shares[role]);
        text += fmt::format("{}", fmt::join(row, ","));
        if (layered) text += fmt::format(",{},{}", patch.thickness_mm, patch.backing);
        if (based) text += fmt::format(",{}", patch.base_mm);
        text += fmt::format(",{}\n", fmt::join(written_values(table.channels, patch, errors), ","));
    }
    return text;
}

}  // namespace voxtone::calibration
