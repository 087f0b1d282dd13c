// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/relief.h"

#include <algorithm>
#include <span>
#include <utility>

namespace voxtone::slicer {

namespace {

constexpr auto row_of = [](const auto& run) { return std::pair(run.k, run.j); };

/// The row with one run more, or less.
std::vector<Span> changed(const std::vector<Span>& row, const ReliefRun& run) {
    std::vector<Span> left;
    for (const Span& span : row) {
        if (span.begin < run.begin) left.push_back({span.begin, std::min(span.end, run.begin)});
        if (span.end > run.end) left.push_back({std::max(span.begin, run.end), span.end});
    }
    if (run.adds) left.push_back({run.begin, run.end});
    std::ranges::sort(left, {}, &Span::begin);
    return left;
}

}  // namespace

Relief::Relief(const std::vector<ReliefRun>& runs, const std::vector<DepthRun>& depths) : runs_(runs), depths_(depths) {
    std::ranges::stable_sort(runs_, {}, row_of);
    std::ranges::stable_sort(depths_, {}, row_of);
}

void Relief::apply(int i, int j, int k, std::span<float> depth_mm) const {
    const auto end = i + static_cast<int>(depth_mm.size());
    for (const DepthRun& run : std::ranges::equal_range(depths_, std::pair(k, j), {}, row_of))
        for (int at = std::max(i, run.begin); at < std::min(end, run.end); ++at) {
            float& depth = depth_mm[static_cast<std::size_t>(at - i)];
            depth = std::max(run.sign * depth + run.offset_mm, 0.0f);
        }
}

void Relief::apply(SpanSlab& body) const {
    const auto first = std::ranges::lower_bound(runs_, body.k_begin(), {}, &ReliefRun::k);
    if (first == runs_.end() || first->k >= body.k_end()) return;
    SpanSlab made;
    made.reset(body.k_begin(), body.k_end(), body.rows());
    auto run = first;
    for (int k = body.k_begin(); k < body.k_end(); ++k)
        for (int j = 0; j < body.rows(); ++j) {
            const std::span<const Span> spans = body.row(j, k);
            std::vector<Span> row(spans.begin(), spans.end());
            for (; run != runs_.end() && run->k == k && run->j == j; ++run) row = changed(row, *run);
            for (const Span& span : row) made.push(span.begin, span.end);
            made.end_row();
        }
    body = std::move(made);
}

}  // namespace voxtone::slicer
