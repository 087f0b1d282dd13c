// SPDX-License-Identifier: GPL-3.0-or-later
//
// Branch and bound for one target (laminate_search.h says how and why it is right).
#pragma once

#include <span>
#include <vector>

#include "scattering/design/laminate_bounds.h"
#include "scattering/design/sub_laminates.h"

namespace voxtone::scattering {

/// What single precision may take from a residual.
inline constexpr double residual_error = 4e-6;

struct DescentTables {
    const LaminateBlocks& blocks;
    const LaminateBounds& bounds;
    std::span<const SubLaminateTree> trees;  ///< of 1, 2, ... blocks
    std::uint32_t max_blocks;
    double tolerance;
};

struct DescentResult {
    std::vector<BlockIndex> blocks;
    double squares;  ///< weighted, in double precision
    SearchCount count;
};

[[nodiscard]] DescentResult descend(const DescentTables& tables, std::span<const double> target);

}  // namespace voxtone::scattering
