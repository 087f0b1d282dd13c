// SPDX-License-Identifier: GPL-3.0-or-later
//
// The least and the most that laminates of exactly e blocks can reflect within a thickness, coefficient by coefficient.
//
// Dynamic programming over e: what is best at one coefficient may be worst at another, so a box holds every laminate,
// and more. The order of blocks and the distance from the top are left out of account, and above 512 steps thickness is
// rounded up to the next of 512 levels: boxes grow, and stay boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scattering/design/laminate_blocks.h"
#include "scattering/design/laminate_lanes.h"

namespace voxtone::scattering {

/// Boxes laid out by lanes, to be filled again and again.
struct LaneBoxes {
    std::vector<float> low, high;
};

class LaminateBounds {
public:
    LaminateBounds(const LaminateBlocks& blocks, std::uint32_t most_blocks);

    /// The boxes of laminates that start with block 16 group + l and have e blocks in all, within `units`. Lanes of
    /// blocks for which there is no such laminate hold anything.
    void next_block(std::uint32_t e, std::uint32_t units, std::size_t group, LaneBoxes& boxes) const;

    /// The box of all laminates of any number of blocks.
    [[nodiscard]] std::span<const float> least() const { return least_; }
    [[nodiscard]] std::span<const float> most() const { return most_; }

private:
    [[nodiscard]] std::size_t level_of(std::uint32_t units) const { return (units + level_units_ - 1) / level_units_; }
    [[nodiscard]] std::size_t place(std::uint32_t e, std::size_t level) const { return e * levels_ + level; }

    const LaminateBlocks& blocks_;
    std::uint32_t level_units_, levels_;
    std::vector<std::vector<float>> low_, high_;  ///< of exactly e blocks within a level; empty: there is none
    std::vector<float> least_, most_;
};

}  // namespace voxtone::scattering
