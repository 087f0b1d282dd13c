// SPDX-License-Identifier: GPL-3.0-or-later
//
// The blocks that laminates are made of (laminate_search.h), their profiles, and the rules by which one may follow
// another.
//
// Coefficients of all channels stand in one row, those that differ most between blocks first, so that sums of squares
// grow fast.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

struct LaminateBlock {
    std::uint32_t material, units;
};
using BlockIndex = std::uint16_t;

class LaminateBlocks {
public:
    /// Checks materials and options: InputError.
    LaminateBlocks(std::span<const LaminateMaterial> materials, const LaminateSearchOptions& options);

    [[nodiscard]] std::size_t size() const { return blocks_.size(); }
    /// Thickest first, then by material.
    [[nodiscard]] const LaminateBlock& operator[](std::size_t b) const { return blocks_[b]; }
    [[nodiscard]] std::size_t coefficients() const { return root_weight_.size(); }
    [[nodiscard]] std::uint32_t units() const { return units_; }

    /// Canonical order: blocks of one material become thinner downwards.
    [[nodiscard]] bool may_follow(BlockIndex upper, BlockIndex lower) const {
        const LaminateBlock &u = blocks_[upper], &l = blocks_[lower];
        return u.material != l.material || l.units < u.units;
    }
    /// Steps that must lie above a block.
    [[nodiscard]] std::uint32_t clear_units(BlockIndex b) const { return clear_units_[blocks_[b].material]; }
    /// Laminates of exactly `count` blocks, for each count up to the limit; those with the clearance broken are left
    /// out.
    [[nodiscard]] std::vector<double> count_laminates(std::uint32_t most_blocks) const;

    [[nodiscard]] std::span<const double> R(std::size_t b) const { return row(R_, b); }
    [[nodiscard]] std::span<const double> T(std::size_t b) const { return row(T_, b); }
    [[nodiscard]] std::span<const float> R_single(std::size_t b) const { return row(R_single_, b); }
    [[nodiscard]] std::span<const float> T_single(std::size_t b) const { return row(T_single_, b); }
    [[nodiscard]] std::span<const double> backing() const { return backing_; }
    [[nodiscard]] std::span<const float> root_weight() const { return root_weight_; }
    /// Of all weights.
    [[nodiscard]] double weight_sum() const { return weight_sum_; }

    /// The reflection of block b over something that reflects x.
    void cover(BlockIndex b, std::span<const float> x, std::span<float> out) const;
    /// Weighted sum of squares between a laminate (blocks from the top) and a target, in double precision.
    [[nodiscard]] double squares(std::span<const BlockIndex> laminate, std::span<const double> target) const;
    /// Profiles as one row, and back. InputError where lengths differ or values are not finite.
    [[nodiscard]] std::vector<double> to_row(const ChannelProfiles& profiles, const char* name) const;
    [[nodiscard]] ChannelProfiles to_channels(std::span<const float> row) const;

private:
    template <class Number>
    std::span<const Number> row(const std::vector<Number>& values, std::size_t b) const {
        return {values.data() + b * coefficients(), coefficients()};
    }

    std::vector<LaminateBlock> blocks_;
    std::uint32_t units_;
    std::vector<std::uint32_t> clear_units_;  ///< by material
    std::size_t channels_, length_;
    std::vector<std::size_t> order_;  ///< place in the row -> channel * length + coefficient
    std::vector<double> R_, T_, backing_, weight_;
    std::vector<float> R_single_, T_single_, root_weight_;
    double weight_sum_ = 0;
};

}  // namespace voxtone::scattering
