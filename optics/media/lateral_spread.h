// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resin that ran sideways before it was cured: what a place holds, given which resin was jetted where.
//
// A droplet is spread within its layer, none of it up or down: layers are cured one by one. With its standard
// deviations sigma_x and sigma_y, mm, the share of resin r at a point p of the body is
//
//   f_r(p) = integral over q of B(q - p) m_r(q),   B(u, v) = b(u / sigma_x) b(v / sigma_y) / (sigma_x sigma_y),
//
// m_r 1 where r was jetted, b the quadratic B-spline of variance 1: the density of a sum of three even draws of width
// 2, nearly a Gaussian and nothing beyond 3. What would run out of the body stays where it was jetted. So B between
// places of the body is symmetric and sums to 1, and the volume of every resin is kept.
//
// Light paths draw q for each particle that they meet (exact by delta tracking); who counts voxels takes means over a
// voxel: `weights`, in which b is widened by the two voxels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "optics/media/resin_volume.h"

namespace voxtone::optics {

/// Wider than this no printer could place a voxel; mm.
inline constexpr double widest_spread_mm = 0.3;

class LateralSpread {
public:
    LateralSpread() = default;
    /// Contract: 0 to widest_spread_mm along x and y; pitch > 0.
    LateralSpread(const std::array<double, 2>& spread_mm, const std::array<double, 3>& pitch_mm);

    /// Whether anything is spread at all.
    [[nodiscard]] bool any() const { return reach_[0] > 0 || reach_[1] > 0; }
    /// No share comes from so many voxels farther, along x and y.
    [[nodiscard]] const std::array<int, 2>& reach() const { return reach_; }
    /// Share that a voxel holds of what was jetted into the one k voxels on, at [k + reach]; symmetric, sum 1.
    [[nodiscard]] std::span<const float> weights(std::size_t axis) const { return weights_[axis]; }
    /// Width of the three even draws, voxels.
    [[nodiscard]] const std::array<float, 2>& draw_voxels() const { return draw_voxels_; }
    /// No particle belongs to a place that is farther away.
    [[nodiscard]] double farthest_mm() const { return farthest_mm_; }
    /// Of the variance of shares from voxel to voxel, where voxels are drawn one by one, what is left: how much of a
    /// sharp voxel's optical size counts in a halftone (effective_medium.h).
    [[nodiscard]] double kept_variance() const;

private:
    std::array<int, 2> reach_{};
    std::array<std::vector<float>, 2> weights_{std::vector<float>{1}, std::vector<float>{1}};
    std::array<float, 2> draw_voxels_{};
    double farthest_mm_ = 0;
};

/// Shares of the resins in the voxels of boxes of a volume.
class SpreadBox {
public:
    /// `volume` and `spread` outlive it; `mirrored` as in mirrored_box.h; so many resins.
    SpreadBox(const ResinVolume& volume, bool mirrored, const LateralSpread& spread, std::size_t resins)
        : volume_(&volume), spread_(&spread), mirrored_(mirrored), resins_(resins) {}

    /// The one resin of the box and of all that reaches it, 0: none; -1: several, and `read` is worth while. Air
    /// beside it does not count.
    [[nodiscard]] int only(const std::array<int, 3>& corner, const std::array<int, 3>& extent);
    /// Fills `shares`.
    void read(const std::array<int, 3>& corner, const std::array<int, 3>& extent);
    /// Of voxel i of the box last read, x fastest; one a resin. All 0 of air.
    [[nodiscard]] std::span<const float> shares(std::size_t voxel) const {
        return std::span(shares_).subspan(voxel * resins_, resins_);
    }
    [[nodiscard]] bool is_air(std::size_t voxel) const { return is_air_[voxel] != 0; }

private:
    void read_surroundings(const std::array<int, 3>& corner, const std::array<int, 3>& extent);
    [[nodiscard]] int only_in_box() const;
    void keep_layers(const std::array<int, 3>& extent, int only);
    void spread_layer(const std::array<int, 3>& extent, int z);

    const ResinVolume* volume_;
    const LateralSpread* spread_;
    bool mirrored_;
    std::size_t resins_;
    std::vector<Material> box_;  ///< with what reaches it
    std::vector<float> along_x_, shares_;
    std::vector<std::uint8_t> is_air_;
};

}  // namespace voxtone::optics
