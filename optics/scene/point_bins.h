// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points sorted into the boxes of a lattice; internal to the smoothing of surfaces.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "optics/numerics/parallel_sort.h"

namespace voxtone::optics {

/// A box, as one number that rises with z, then y, then x, then what else tells the points of a box apart (`kind`, 0 to
/// 7): 20 bits for each place; boxes further out than 2^19 from the origin count as the outermost.
using Bin = std::uint64_t;

struct BoxPlace {
    std::int64_t z, y, x;
};

inline BoxPlace place_of(const std::array<float, 3>& p, float edge) {
    const auto place = [&](float v) {
        constexpr float most = 500000;
        return static_cast<std::int64_t>(std::floor(std::clamp(v / edge, -most, most)));
    };
    return {place(p[2]), place(p[1]), place(p[0])};
}

inline Bin bin_of(const BoxPlace& place, unsigned kind = 0) {
    const auto part = [](std::int64_t v) {
        return static_cast<Bin>(std::clamp<std::int64_t>(v + (1 << 19), 0, (1 << 20) - 1));
    };
    return (part(place.z) << 43) | (part(place.y) << 23) | (part(place.x) << 3) | kind;
}

inline Bin bin_of(const std::array<float, 3>& p, float edge) { return bin_of(place_of(p, edge)); }

struct BinnedPoints {
    std::vector<std::uint32_t> order;  ///< points by bin, within a bin by index
    std::vector<std::uint32_t> begin;  ///< in `order`; one more than there are bins
    std::vector<Bin> bins;             ///< that are not empty, ascending
};

template <class BinOf>
BinnedPoints sort_into_bins(std::size_t count, BinOf&& bin_of_point) {
    std::vector<std::pair<Bin, std::uint32_t>> sorted(count);
    parallel_for(0, count, 4096, [&](std::size_t i) { sorted[i] = {bin_of_point(i), static_cast<std::uint32_t>(i)}; });
    parallel_sort(std::span(sorted));
    BinnedPoints s;
    s.order.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        s.order[i] = sorted[i].second;
        if (i > 0 && sorted[i].first == s.bins.back()) continue;
        s.begin.push_back(static_cast<std::uint32_t>(i));
        s.bins.push_back(sorted[i].first);
    }
    s.begin.push_back(static_cast<std::uint32_t>(count));
    return s;
}

}  // namespace voxtone::optics
