// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/scene/area_summary.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "voxtone/base/contracts.h"

namespace voxtone::optics {

DifferenceSummary summarize_by_area(const Surface& cells, std::span<const double> differences,
                                    std::span<const char> counts) {
    VOXTONE_EXPECT(cells.cells.size() == differences.size() && (counts.empty() || counts.size() == differences.size()));
    std::vector<std::pair<double, std::uint32_t>> order;  // side by side: sorting does not jump about
    order.reserve(differences.size());
    for (std::size_t i = 0; i < differences.size(); ++i)
        if (counts.empty() || counts[i]) order.emplace_back(differences[i], static_cast<std::uint32_t>(i));
    DifferenceSummary summary;
    summary.count = order.size();
    if (order.empty()) return summary;
    std::sort(order.begin(), order.end());
    double area = 0, sum = 0;
    for (const auto& [difference, i] : order) {
        area += cells.cells[i].area_mm2;
        sum += cells.cells[i].area_mm2 * difference;
    }
    summary.mean = sum / area;
    summary.max = order.back().first;
    const auto percentile = [&](double share) {
        double up_to = 0;
        for (const auto& [difference, i] : order)
            if ((up_to += cells.cells[i].area_mm2) >= share * area) return difference;
        return summary.max;
    };
    summary.median = percentile(0.5);
    summary.percentile_95 = percentile(0.95);
    return summary;
}

}  // namespace voxtone::optics
