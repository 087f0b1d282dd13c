// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/tray_verdict.h"

#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace voxtone::slicer {

namespace {

std::string names_of(const std::vector<const io::ReportPart*>& parts) {
    constexpr std::size_t most = 5;
    std::vector<std::string> names;
    for (const io::ReportPart* part : parts) names.push_back(part->name);
    if (names.size() <= most) return fmt::format("{}", fmt::join(names, ", "));
    const std::size_t more = names.size() - most;
    names.resize(most);
    return fmt::format("{} and {} more", fmt::join(names, ", "), more);
}

}  // namespace

io::ReportVerdict tray_verdict(const std::vector<const io::ReportPart*>& bodies) {
    std::vector<const io::ReportPart*> bad, fair, unknown;
    const std::size_t all = bodies.size();
    for (const io::ReportPart* body : bodies) {
        if (body->level == io::VerdictLevel::bad) bad.push_back(body);
        if (body->level == io::VerdictLevel::fair) fair.push_back(body);
        if (body->level == io::VerdictLevel::unknown) unknown.push_back(body);
    }
    io::ReportVerdict verdict;
    if (!bad.empty()) {
        verdict.level = io::VerdictLevel::bad;
        verdict.headline = fmt::format("{} of {} bodies will not look as asked{}", bad.size(), all,
                                       fair.empty() ? "" : fmt::format(", {} will nearly", fair.size()));
        verdict.why = names_of(bad) + (fair.empty() ? "" : "; nearly: " + names_of(fair)) +
                      ". Each has its reason and what to try on its own page.";
    } else if (!fair.empty()) {
        verdict.level = io::VerdictLevel::fair;
        const std::size_t good = all - fair.size() - unknown.size();
        verdict.headline = good == 0
                               ? fmt::format("{} of {} bodies will look nearly as asked", fair.size(), all)
                               : fmt::format("{} of {} bodies will look as asked, {} nearly", good, all, fair.size());
        verdict.why = names_of(fair) + ". What limits them is on their own pages.";
    } else if (unknown.size() < all) {
        verdict.level = io::VerdictLevel::good;
        verdict.headline = all == unknown.size() + 1 ? "It will look as asked" : "All bodies will look as asked";
    } else {
        verdict.headline = "Nothing was predicted";
        verdict.why = "Parts have their colours in reach below; --predict transport says how they will look.";
    }
    if (!unknown.empty() && unknown.size() < all) verdict.why += " Not predicted: " + names_of(unknown) + ".";
    verdict.sentence = verdict.headline + "." + (verdict.why.empty() ? "" : " ") + verdict.why;
    return verdict;
}

}  // namespace voxtone::slicer
