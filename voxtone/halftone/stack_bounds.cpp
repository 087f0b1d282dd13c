// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/stack_bounds.h"

#include <algorithm>

#include "voxtone/base/contracts.h"

namespace voxtone::halftone {
namespace {

/// Boxes of stackings of exactly e blocks, by level; `possible` where there is one.
struct LevelBoxes {
    std::vector<std::vector<float>> low, high;
    std::vector<char> possible;
};

}  // namespace

StackBounds::StackBounds(const StackBlocks& blocks, std::uint32_t first_lanes, std::uint32_t most_blocks)
    : level_units_((blocks.units() + 15) / 16),
      levels_((blocks.units() + level_units_ - 1) / level_units_ + 1),
      first_lanes_(first_lanes),
      groups_((blocks.size() + stack_lanes - 1) / stack_lanes),
      coefficients_(blocks.coefficients()) {
    const std::size_t n = coefficients_;
    LevelBoxes below;  // e = 0: the backing
    const std::vector<float> backing(blocks.backing().begin(), blocks.backing().end());
    below.low.assign(levels_, backing);
    below.high.assign(levels_, backing);
    below.possible.assign(levels_, 1);
    least_ = most_ = backing;
    std::vector<float> low(n), high(n);
    for (std::uint32_t e = 1; e <= most_blocks; ++e) {
        LevelBoxes next;
        next.low.assign(levels_, std::vector<float>(n, 1.0F));
        next.high.assign(levels_, std::vector<float>(n, 0.0F));
        next.possible.assign(levels_, 0);
        std::vector<float>*lanes_low = nullptr, *lanes_high = nullptr;
        if (e >= first_lanes) {
            lanes_low = &low_.emplace_back(levels_ * groups_ * n * stack_lanes, 0.0F);
            lanes_high = &high_.emplace_back(levels_ * groups_ * n * stack_lanes, 1.0F);
        }
        for (std::size_t level = 0; level < levels_; ++level) {
            const std::uint32_t units = std::min(static_cast<std::uint32_t>(level) * level_units_, blocks.units());
            for (std::size_t b = 0; b < blocks.size(); ++b) {
                if (blocks[b].units > units) continue;
                const std::size_t rest = level_of(units - blocks[b].units);
                if (!below.possible[rest]) continue;
                const auto block = static_cast<BlockIndex>(b);
                blocks.cover(block, below.low[rest], low);
                blocks.cover(block, below.high[rest], high);
                next.possible[level] = 1;
                for (std::size_t i = 0; i < n; ++i) {
                    next.low[level][i] = std::min(next.low[level][i], low[i]);
                    next.high[level][i] = std::max(next.high[level][i], high[i]);
                }
                if (lanes_low == nullptr) continue;
                const std::size_t base = (level * groups_ + b / stack_lanes) * n * stack_lanes + b % stack_lanes;
                for (std::size_t i = 0; i < n; ++i) {
                    (*lanes_low)[base + i * stack_lanes] = low[i];
                    (*lanes_high)[base + i * stack_lanes] = high[i];
                }
            }
        }
        below = std::move(next);
        if (below.possible.back()) {
            for (std::size_t i = 0; i < n; ++i) {
                least_[i] = std::min(least_[i], below.low.back()[i]);
                most_[i] = std::max(most_[i], below.high.back()[i]);
            }
        }
    }
}

StackBounds::Lanes StackBounds::lanes(std::uint32_t e, std::uint32_t units, std::size_t group) const {
    VOXTONE_DEBUG_EXPECT(e >= first_lanes_);
    const std::size_t base = (level_of(units) * groups_ + group) * coefficients_ * stack_lanes;
    return {low_[e - first_lanes_].data() + base, high_[e - first_lanes_].data() + base};
}

}  // namespace voxtone::halftone
