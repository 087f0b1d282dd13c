// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/relief.h"

#include <algorithm>
#include <span>
#include <tuple>

namespace voxtone::slicer {

namespace {

bool is_before(const ReliefRun& a, const ReliefRun& b) { return std::tie(a.k, a.j) < std::tie(b.k, b.j); }

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

Relief::Relief(const std::vector<ReliefRun>& runs) : runs_(runs) { std::ranges::stable_sort(runs_, is_before); }

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
