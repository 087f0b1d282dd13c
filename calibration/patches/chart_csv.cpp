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
#include "io/files/csv_table.h"

namespace voxtone::calibration {

namespace {

// "# resins: W,C,Vio" among the first lines, also where a spreadsheet has filled them with separators.
std::vector<std::string> told_resins(std::string_view text) {
    constexpr std::string_view word = "RESINS:", filling = " \t,;\"";
    std::vector<std::string> resins;
    std::size_t from = 0;
    for (int line = 0; line < 100 && from < text.size(); ++line) {
        const std::size_t to = std::min(text.find_first_of("\r\n", from), text.size());
        std::string_view comment = text.substr(from, to - from);
        from = to + 1;
        comment.remove_prefix(std::min(comment.find_first_not_of(filling), comment.size()));
        if (!comment.starts_with('#')) continue;
        comment = trimmed(comment.substr(1, comment.find_last_not_of(filling)));
        if (!in_capitals(comment.substr(0, word.size())).starts_with(word)) continue;
        for (const std::string_view role : split(comment.substr(word.size()), ','))
            if (is_role(role)) resins.emplace_back(role);
    }
    return resins;
}

class ChartCsvReader {
public:
    ChartCsvReader(std::string_view text, const std::string& source, const ColumnWords& words)
        : text_(text), words_(words), told_(told_resins(text)) {
        reading_.table.source = source;
        known_.assign(words.known.begin(), words.known.end());
        known_.insert(known_.end(), told_.begin(), told_.end());
        words_.known = known_;
    }

    ChartReading read() {
        io::CsvReader csv(text_, io::CsvRules::lenient, [&](const auto& cells) { return is_header(cells); });
        if (csv.header().cells.empty())
            throw InputError(fmt::format(
                "{}: has no header line; a chart begins with a line such as W,C,M,Y,K,L,a,b, and a target with "
                "top,backing,thickness_mm,R,G,B.",
                reading_.table.source));
        header(csv);
        io::CsvRow row;
        for (std::string fault; csv.next(row, fault);) {
            line_ = row.line;
            if (!fault.empty()) throw InputError(fmt::format("{}: {}.", where(), fault));
            patch(row.cells);
        }
        for (const std::string& comment : csv.comments()) {
            const std::size_t colon = comment.find(':');
            if (colon != std::string::npos)
                note_condition(reading_.conditions, comment.substr(0, colon), comment.substr(colon + 1));
        }
        put_columns_in(*columns_, reading_);
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

    // Instruments write titles above the header.
    bool is_header(const std::vector<std::string>& cells) const {
        const std::vector<std::string_view> names(cells.begin(), cells.end());
        try {
            return !chart_columns(names, {}, words_).columns.empty();
        } catch (const InputError&) {
            return false;
        }
    }

    void header(const io::CsvReader& csv) {
        line_ = csv.header().line;
        const std::vector<std::string_view> names(csv.header().cells.begin(), csv.header().cells.end());
        columns_ = chart_columns(names, where(), words_);
        if (csv.lines_above() > 0)
            reading_.table.notes.push_back(fmt::format("{}: what stands above the header in line {} is left aside.",
                                                       reading_.table.source, line_));
    }

    void patch(const std::vector<std::string>& cells) {
        if (reading_.table.patches.size() >= most_chart_patches)
            throw InputError(fmt::format("{}: more than {} patches.", where(), most_chart_patches));
        cells_.assign(cells.begin(), cells.end());
        if (is_unmeasured(*columns_, cells_))
            ++unmeasured_;
        else
            reading_.table.patches.push_back(chart_row(*columns_, cells_, where()));
    }

    std::string_view text_;
    ColumnWords words_;
    std::vector<std::string> told_, known_;
    ChartReading reading_;
    std::optional<ChartColumns> columns_;
    std::vector<std::string_view> cells_;
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

ChartReading read_chart_csv(std::string_view text, const std::string& source, const ColumnWords& words) {
    return ChartCsvReader(text, source, words).read();
}

std::string resins_comment(const std::vector<std::string>& roles) {
    return std::ranges::all_of(roles, is_known_role) ? std::string()
                                                     : comment_lines(fmt::format("resins: {}", fmt::join(roles, ",")));
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
    text += resins_comment(roles) + fmt::format("{}", fmt::join(roles, ","));
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
