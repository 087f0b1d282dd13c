// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_bounds.h"

#include <algorithm>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::scattering {
namespace {

constexpr std::uint32_t most_levels = 512;

}  // namespace

LaminateBounds::LaminateBounds(const LaminateBlocks& blocks, std::uint32_t most_blocks)
    : blocks_(blocks),
      level_units_((blocks.units() + most_levels - 1) / most_levels),
      levels_((blocks.units() + level_units_ - 1) / level_units_ + 1),
      low_((most_blocks + 1) * levels_),
      high_(low_.size()),
      least_(blocks.backing().begin(), blocks.backing().end()),
      most_(least_) {
    const std::size_t n = blocks.coefficients();
    for (std::size_t level = 0; level < levels_; ++level) low_[place(0, level)] = high_[place(0, level)] = least_;
    for (std::uint32_t e = 1; e <= most_blocks; ++e) {
        parallel_for(0, levels_, 4, [&](std::size_t level) {
            const std::uint32_t units = std::min(static_cast<std::uint32_t>(level) * level_units_, blocks.units());
            std::vector<float>&low = low_[place(e, level)], &high = high_[place(e, level)];
            for (std::size_t b = 0; b < blocks.size(); ++b) {
                if (blocks[b].units > units) continue;
                const std::size_t rest = place(e - 1, level_of(units - blocks[b].units));
                if (low_[rest].empty()) continue;
                if (low.empty()) {
                    low.assign(n, 1.0F);
                    high.assign(n, 0.0F);
                }
                const auto block = static_cast<BlockIndex>(b);
                widen_box({blocks.R_single(block).data(), blocks.T_single(block).data()}, low_[rest], high_[rest], low,
                          high);
            }
        });
        const std::size_t all = place(e, levels_ - 1);
        if (low_[all].empty()) continue;
        for (std::size_t i = 0; i < n; ++i) {
            least_[i] = std::min(least_[i], low_[all][i]);
            most_[i] = std::max(most_[i], high_[all][i]);
        }
    }
}

void LaminateBounds::next_block(std::uint32_t e, std::uint32_t units, std::size_t group, LaneBoxes& boxes) const {
    VOXTONE_DEBUG_EXPECT(e > 0);
    const std::size_t n = blocks_.coefficients();
    boxes.low.resize(n * laminate_lanes);
    boxes.high.resize(n * laminate_lanes);
    std::vector<float> low(n), high(n);
    for (std::size_t l = 0; l < laminate_lanes; ++l) {
        const std::size_t b = group * laminate_lanes + l;
        if (b >= blocks_.size() || blocks_[b].units > units) continue;
        const std::size_t rest = place(e - 1, level_of(units - blocks_[b].units));
        if (low_[rest].empty()) continue;
        std::fill(low.begin(), low.end(), 1.0F);
        std::fill(high.begin(), high.end(), 0.0F);
        widen_box({blocks_.R_single(b).data(), blocks_.T_single(b).data()}, low_[rest], high_[rest], low, high);
        for (std::size_t i = 0; i < n; ++i) {
            boxes.low[i * laminate_lanes + l] = low[i];
            boxes.high[i * laminate_lanes + l] = high[i];
        }
    }
}

}  // namespace voxtone::scattering
