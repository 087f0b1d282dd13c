// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points sorted into the boxes of a lattice; internal to the smoothing of surfaces.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "voxtone/base/parallel.h"

namespace voxtone::halftone {

using Bin = std::array<std::int32_t, 4>;  ///< z, y, x of the box, and what else tells its points apart

inline Bin bin_of(const std::array<float, 3>& p, float edge) {
    return {static_cast<std::int32_t>(std::floor(p[2] / edge)), static_cast<std::int32_t>(std::floor(p[1] / edge)),
            static_cast<std::int32_t>(std::floor(p[0] / edge)), 0};
}

struct BinnedPoints {
    std::vector<std::uint32_t> order;  ///< points by bin, within a bin by index
    std::vector<std::uint32_t> begin;  ///< in `order`; one more than there are bins
    std::vector<Bin> bins;             ///< that are not empty, ascending
};

template <class BinOf>
BinnedPoints sort_into_bins(std::size_t count, BinOf&& bin_of_point) {
    std::vector<Bin> bin(count);
    parallel_for(0, count, 4096, [&](std::size_t i) { bin[i] = bin_of_point(i); });
    BinnedPoints s;
    s.order.resize(count);
    std::iota(s.order.begin(), s.order.end(), 0U);
    std::stable_sort(s.order.begin(), s.order.end(), [&](std::uint32_t a, std::uint32_t b) { return bin[a] < bin[b]; });
    for (std::size_t i = 0; i < count; ++i)
        if (i == 0 || bin[s.order[i]] != s.bins.back()) {
            s.begin.push_back(static_cast<std::uint32_t>(i));
            s.bins.push_back(bin[s.order[i]]);
        }
    s.begin.push_back(static_cast<std::uint32_t>(count));
    return s;
}

}  // namespace voxtone::halftone
