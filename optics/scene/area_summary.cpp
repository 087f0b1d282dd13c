// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/area_summary.h"

#include <cstdint>
#include <span>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/numerics/parallel_sort.h"

namespace voxtone::optics {

namespace {

/// Side by side: neither sorting nor summing jumps about.
struct Piece {
    double difference;
    std::uint32_t cell;
    float area;  ///< mm^2
    bool operator<(const Piece& other) const {
        return difference != other.difference ? difference < other.difference : cell < other.cell;
    }
};

}  // namespace

DifferenceSummary summarize_by_area(const Surface& cells, std::span<const double> differences,
                                    std::span<const char> counts) {
    VOXTONE_EXPECT(cells.cells.size() == differences.size() && (counts.empty() || counts.size() == differences.size()));
    std::vector<Piece> order;
    order.reserve(differences.size());
    for (std::size_t i = 0; i < differences.size(); ++i)
        if (counts.empty() || counts[i])
            order.push_back({differences[i], static_cast<std::uint32_t>(i), cells.cells[i].area_mm2});
    DifferenceSummary summary;
    summary.count = order.size();
    if (order.empty()) return summary;
    parallel_sort(std::span(order));
    double area = 0, sum = 0;
    for (const Piece& piece : order) {
        area += piece.area;
        sum += piece.area * piece.difference;
    }
    summary.mean = sum / area;
    summary.max = order.back().difference;
    const auto percentile = [&](double share) {
        double up_to = 0;
        for (const Piece& piece : order)
            if ((up_to += piece.area) >= share * area) return piece.difference;
        return summary.max;
    };
    summary.median = percentile(0.5);
    summary.percentile_95 = percentile(0.95);
    return summary;
}

}  // namespace voxtone::optics
