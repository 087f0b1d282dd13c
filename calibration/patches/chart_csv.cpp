// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_csv.h"

#include <algorithm>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/contracts.h"
#include "base/error.h"
#include "calibration/patches/chart_columns.h"
#include "calibration/tables/table_cells.h"

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

ChartReading read_chart_csv(std::string_view text, const std::string& source, ColumnWords words) {
    std::vector<std::string> known(words.known.begin(), words.known.end());
    std::ranges::copy(told_resins(text), std::back_inserter(known));
    words.known = known;
    // Instruments write titles above the header.
    const auto is_header = [&](const std::vector<std::string>& names) {
        try {
            return !chart_columns(names, {}, words).columns.empty();
        } catch (const InputError&) {
            return false;
        }
    };
    CsvText table(
        text, source,
        "a chart begins with a line such as W,C,M,Y,K,L,a,b, and a target with top,backing,thickness_mm,R,G,B",
        is_header);
    const ChartColumns columns = chart_columns(table.names(), table.where(), words);
    ChartReading reading;
    reading.table.source = source;
    if (table.lines_above() > 0)
        reading.table.notes.push_back(fmt::format("{}: what stands above the header is left aside.", table.where()));
    take_rows(table, columns, reading);
    return reading;
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
