// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many paths each cell and channel gets, who traces them, and what their weights add up to: the part of Monte Carlo
// that does not know what a path is.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>

#include "optics/monte_carlo/monte_carlo_options.h"
#include "optics/monte_carlo/path_random.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

// Weights are summed as whole numbers of 2^-32: the sum does not depend on the order, 1 is exact.
inline constexpr double path_weight_unit = 0x1p-32;
[[nodiscard]] inline std::uint64_t in_units(double weight) {
    return static_cast<std::uint64_t>(weight / path_weight_unit);
}

/// Sums over the paths of one cell and channel. Added to by any thread.
struct Tally {
    std::atomic<std::uint64_t> weight{0}, square{0};

    void add(std::uint64_t w, std::uint64_t w2) {
        weight.fetch_add(w, std::memory_order_relaxed);
        square.fetch_add(w2, std::memory_order_relaxed);
    }
    /// Of n paths.
    [[nodiscard]] double mean(double n) const { return static_cast<double>(weight) * path_weight_unit / n; }
    /// Of the mean, from the spread of the weights.
    [[nodiscard]] double error(double n) const {
        const double m = mean(n), mean_square = static_cast<double>(square) * path_weight_unit / n;
        return std::sqrt(std::max(0.0, mean_square - m * m) / (n - 1));
    }
    /// The same for deciding when to stop: as if one more path had counted fully, so that a dark cell is not believed
    /// to be black before it had the paths to know.
    [[nodiscard]] double careful_error(double n) const { return std::hypot(error(n), 1 / n); }
};

/// Some paths of one cell and channel; value = cell * channels + channel.
struct Share {
    std::uint32_t value, first, count;
};

/// The address of path number `path` of a share.
[[nodiscard]] PathAddress path_address(const Surface& surface, std::size_t channels, const MonteCarloOptions& options,
                                       const Share& share, std::uint32_t path);

/// Traces some shares, all of one channel, and adds to their tallies. Called from any thread.
using TraceShares = std::function<void(std::size_t channel, std::span<const Share>, std::span<Tally>)>;

/// Draws paths in rounds until the options are met.
[[nodiscard]] Appearance draw_paths(std::size_t cells, std::size_t channels, const MonteCarloOptions& options,
                                    const TraceShares& trace, MonteCarloSummary& summary, const Progress* progress);

}  // namespace voxtone::optics
