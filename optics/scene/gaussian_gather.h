// SPDX-License-Identifier: GPL-3.0-or-later
//
// A Gaussian over points of a surface, summed directly:
//
//   out_i = sum_j w_ij in_j / sum_j w_ij,   w_ij = area_j (n_i . n_j) exp(-|x_i - x_j|^2 / spread^2)
//
// over the points that are seen together: normals less than 70 degrees apart (the other side of a wall is not), and a
// chord within 30 degrees of the plane across their mean normal (a parallel sheet behind this one is not; on a sphere
// that angle is zero). |x_i - x_j| is the chord. The kernel ends at 2.8 spreads. Dividing by the weight that is there
// keeps a constant and treats borders as if nothing lay beyond.
//
// Points are summed in an order of their own, without fused operations: the same bits for any number of threads and any
// width of vectors. Memory: 32 bytes per point of `from` and, where these are others, 4 per point of `to`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace voxtone::optics {

struct SurfacePoint {
    std::array<float, 3> at{};      ///< mm
    std::array<float, 3> normal{};  ///< unit length
    float area = 0;                 ///< mm^2, > 0
};

class GaussianGather {
public:
    /// `fallback[i]`: the point of `from` that point i of `to` takes its value from where it sees none. `slack_mm`: a
    /// chord may leave the surface by this much besides. `to` and `fallback` must outlive this.
    GaussianGather(std::span<const SurfacePoint> from, std::span<const SurfacePoint> to,
                   std::span<const std::uint32_t> fallback, double spread_mm, double slack_mm);
    /// Among the same points: each takes its own value where it sees none.
    GaussianGather(std::span<const SurfacePoint> points, double spread_mm, double slack_mm);
    /// `channels` values per point, interleaved: 1, 2, 3 or 6.
    void apply(std::span<const float> in, std::span<float> out, std::size_t channels) const;

private:
    [[nodiscard]] std::span<const std::uint32_t> to_order() const { return same_ ? from_order_ : to_order_; }
    template <int Channels>
    void apply_channels(const float* in, float* out) const;
    std::span<const SurfacePoint> to_;
    std::vector<SurfacePoint> from_sorted_;    ///< in the order of from_order_: read in one go
    std::span<const std::uint32_t> fallback_;  ///< empty among the same points
    bool same_;
    float spread_, slack_;
    std::vector<std::uint32_t> from_order_, to_order_;             ///< points sorted by bin; among the same, one order
    std::vector<std::uint32_t> group_begin_;                       ///< in to_order(); one more than there are groups
    std::vector<std::uint32_t> ranges_begin_;                      ///< per group
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges_;  ///< in from_order_: who may be near
};

}  // namespace voxtone::optics
