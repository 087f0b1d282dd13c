// SPDX-License-Identifier: GPL-3.0-or-later
//
// Shares of a place in whole counts, so that over many places each keeps its share: one ladder of all shares, n rungs a
// unit, whose first rung lies at `chance` in [0, 1). With S_r the sum of the first r shares
//
//   count_r = floor(n S_r + chance) - floor(n S_{r-1} + chance).
#pragma once

#include <cstddef>
#include <span>
#include <utility>

namespace voxtone::optics {

/// `give(r, count)` for each share whose count is above 0, ascending. Where none is, the largest gets 1.
template <class Give>
void climb_ladder(std::span<const double> shares, int rungs, double chance, Give&& give) {
    constexpr double rounding = 1e-6;  // shares come in single precision
    double counted = 0;
    int given = 0;
    std::size_t most = 0;
    for (std::size_t r = 0; r < shares.size(); ++r) {
        if (shares[r] > shares[most]) most = r;
        counted += shares[r];
        const int below = static_cast<int>(counted * rungs + chance + rounding);
        if (below > given) give(r, below - std::exchange(given, below));
    }
    if (given == 0) give(most, 1);
}

}  // namespace voxtone::optics
