// SPDX-License-Identifier: GPL-3.0-or-later
//
// Multigrid on sparse rows: the levels of diffusion from one node a block upwards (viewing_diffusion.h has the finer
// ones).
//
//   sum_j c_ij (x_i - x_j) + l_i x_i = b_i
//
// Nodes are gathered to 8 a block, 1 a block, then 2 x 2 x 2 blocks and so on; coarse conductances are sums of those of
// the contacts between, times the ratio of the distances (what rediscretising gives); symmetric Gauss-Seidel before and
// after. Work and memory are linear in the number of nodes. Deterministic.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"

namespace voxtone::optics {

/// The pattern of the equations: the same for all channels.
class MultigridPlan {
public:
    struct Contact {
        std::uint32_t a, b;
        friend auto operator<=>(const Contact&, const Contact&) = default;
    };
    /// For nodes at these places, in viewing cells, which are apart by 1 or more, and contacts between them.
    MultigridPlan(std::vector<std::array<float, 3>> centre, std::span<const Contact> contacts);

    struct Level {
        std::vector<std::uint32_t> row, column;  ///< neighbours of node i: column[row[i]] .. column[row[i + 1] - 1]
        std::vector<std::uint32_t> parent;       ///< of each node, on the next level; empty on the last
        /// Finer level's contact (row entry) -> entry here, or `none` where both ends have one parent; and its ratio.
        std::vector<std::uint32_t> gathered;
        std::vector<float> ratio;
        [[nodiscard]] std::size_t nodes() const { return row.size() - 1; }
    };
    static constexpr std::uint32_t none = 0xffffffffu;
    std::vector<Level> levels;
    std::vector<std::vector<std::uint32_t>> twins;  ///< of level l + 1: the entry of the same contact in the other row
    std::vector<std::uint32_t> entry_ab, entry_ba;  ///< of each contact, on level 0
    [[nodiscard]] std::size_t memory_bytes() const;
};

class Multigrid {
public:
    /// `conductance` per contact, `loss` per node.
    Multigrid(const MultigridPlan& plan, std::span<const float> conductance, std::span<const float> loss);

    /// x: roughly the solution for this right side, by one V-cycle. Throws Cancelled.
    void cycle(std::span<const float> right_side, std::span<float> x, const Progress* progress = nullptr) const {
        cycle(0, right_side, x, progress);
    }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Values {
        std::vector<float> c;              ///< per entry
        std::vector<float> inverse, loss;  ///< 1 / diagonal
    };
    void cycle(std::size_t level, std::span<const float> b, std::span<float> x, const Progress* progress) const;

    const MultigridPlan& plan_;
    std::vector<Values> values_;
    mutable std::vector<std::vector<float>> b_, x_;  ///< of the coarse levels
};

}  // namespace voxtone::optics
