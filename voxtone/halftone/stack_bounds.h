// SPDX-License-Identifier: GPL-3.0-or-later
//
// The least and the most that stackings of exactly e blocks can reflect within a thickness, coefficient by coefficient.
//
// Dynamic programming over e: what is best at one coefficient may be worst at another, so a box holds every stacking,
// and more. The order of blocks and the distance from the top are left out of account, thickness is rounded up to
// sixteenths: boxes grow, and stay boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxtone/halftone/stack_blocks.h"
#include "voxtone/halftone/stack_lanes.h"

namespace voxtone::halftone {

class StackBounds {
public:
    /// Boxes of one next block and what follows it are kept for e in [first_lanes, most_blocks].
    StackBounds(const StackBlocks& blocks, std::uint32_t first_lanes, std::uint32_t most_blocks);

    /// The boxes of stackings that start with block 16 g + l and have e blocks in all, within `units`; laid out by
    /// lanes.
    struct Lanes {
        const float *low, *high;
    };
    [[nodiscard]] std::size_t groups() const { return groups_; }
    [[nodiscard]] Lanes lanes(std::uint32_t e, std::uint32_t units, std::size_t group) const;

    /// The box of all stackings of any number of blocks.
    [[nodiscard]] std::span<const float> least() const { return least_; }
    [[nodiscard]] std::span<const float> most() const { return most_; }

private:
    [[nodiscard]] std::size_t level_of(std::uint32_t units) const { return (units + level_units_ - 1) / level_units_; }

    std::uint32_t level_units_, levels_, first_lanes_;
    std::size_t groups_, coefficients_;
    std::vector<std::vector<float>> low_, high_;  ///< by e - first_lanes: [level][group][coefficient][lane]
    std::vector<float> least_, most_;
};

}  // namespace voxtone::halftone
