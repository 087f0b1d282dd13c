// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/whole_verdict.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <fmt/core.h>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

WholeVerdict judge_colours(std::span<const double> difference, std::span<const double> weight,
                           std::span<const char> spoilt, const VerdictLimits& limits) {
    constexpr double most = 0.5;
    VOXTONE_EXPECT(difference.size() == weight.size() && (spoilt.empty() || spoilt.size() == weight.size()));
    double all = 0, sum = 0, off = 0, wrong = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        all += weight[i], sum += weight[i] * difference[i];
        if (difference[i] > limits.bad) off += weight[i];
        if (difference[i] > limits.bad || (!spoilt.empty() && spoilt[i] != 0)) wrong += weight[i];
    }
    if (!(all > 0)) return {};
    WholeVerdict whole{.mean = sum / all, .wrong_share = wrong / all, .off_share = off / all};
    using enum io::VerdictLevel;
    whole.level = whole.mean > limits.bad || off > most * all                  ? bad
                  : whole.mean > limits.good || whole.wrong_share > much_wrong ? fair
                                                                               : good;
    return whole;
}

/// With a digit more where one would make it the limit that it is above.
std::string figure(double mean, double limit) {
    const std::string text = fmt::format("{:.1f}", mean);
    return mean > limit && text == fmt::format("{:.1f}", limit) ? fmt::format("{:.2f}", mean) : text;
}

}  // namespace

WholeVerdict judge_whole(std::span<const double> difference, std::span<const double> weight,
                         std::span<const char> spoilt, const VerdictLimits& limits, const PageVerdict& page) {
    using enum io::VerdictLevel;
    WholeVerdict whole = judge_colours(difference, weight, spoilt, limits);
    if (whole.level == bad && !page.served.empty()) {
        std::vector<double> served(difference.begin(), difference.end());
        for (std::size_t i = 0; i < served.size(); ++i)
            if (page.served[i] != 0) served[i] = std::min(served[i], limits.good);
        if (judge_colours(served, weight, spoilt, limits).level != bad)
            whole.level = fair, whole.decided_by = "a scanner reads its code";
    }
    if (!page.lost.empty() && whole.level != bad) whole.level = fair, whole.decided_by = page.lost;
    if (!page.useless.empty()) whole.level = bad, whole.decided_by = page.useless;
    return whole;
}

std::string opening_of(const WholeVerdict& whole, const VerdictLimits& limits) {
    if (whole.level == io::VerdictLevel::unknown) return "How it will look was not predicted";
    const bool is_bad = whole.level == io::VerdictLevel::bad;
    if (!whole.decided_by.empty())
        return fmt::format("On the whole {}: {}; its colours are {:.1f} off", is_bad ? "bad" : "fair", whole.decided_by,
                           whole.mean);
    const double limit = is_bad ? limits.bad : limits.good;
    std::string text = figure(whole.mean, limit);
    if (whole.level == io::VerdictLevel::good) return "On the whole good, " + text;
    if (whole.mean <= limit) {
        constexpr double nearly_all = 0.9, hardly_any = 0.1;
        const double off = whole.off_share / whole.wrong_share;
        text += fmt::format(", and {:.0f} % of what is seen is {}", 100 * whole.wrong_share,
                            off > nearly_all   ? "clearly off"
                            : off < hardly_any ? "flecked or blurred"
                                               : "clearly off, flecked or blurred");
    }
    return is_bad ? fmt::format("On the whole bad, {}: it will not look as asked", text)
                  : fmt::format("On the whole fair, {}: much as asked, with differences that are seen", text);
}

double weighted_percentile(std::span<const double> difference, std::span<const double> weight, double part) {
    std::vector<std::size_t> order(difference.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return difference[i]; });
    const double all = std::accumulate(weight.begin(), weight.end(), 0.0);
    double sum = 0;
    for (const std::size_t i : order)
        if (sum += weight[i]; sum >= part * all) return difference[i];
    return order.empty() ? 0 : difference[order.back()];
}

}  // namespace voxtone::slicer
