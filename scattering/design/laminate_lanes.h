// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sixteen boxes of lower laminates at once, seen through one upper laminate: the innermost loop of the laminate search.
//
// An upper laminate (T, R, R' from below) over a lower one that reflects x shows R + T^2 x / (1 - R' x), which only
// grows with x, so a box [low, high] of what may lie below maps to an interval, and the target's distance to that
// interval is reached at the point of the box that is nearest to q, the x that would show the target. Weighted squares
// of it, summed over the coefficients, are a lower bound for whatever laminate has its reflection in the box; for a box
// without extent they are the distance itself.
//
// One lane is one box, and its sum runs over the coefficients in their order: no bit depends on the width of the
// vectors. Single precision: a residual is wrong by at most 4e-6 (laminate_search.h says what that means for the
// result).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace voxtone::scattering {

inline constexpr std::size_t laminate_lanes = 16;

/// Coefficients between two looks at the limit.
inline constexpr std::size_t lane_stride = 8;

/// Where sixteen boxes are kept: the value of lane l at coefficient i at [16 i + l].
using LaneSums = std::array<float, laminate_lanes>;

/// An upper laminate and a target, folded: sqrt(weight) times the residual is a + b x / (1 - c x), zero at x = q.
struct SeenThrough {
    std::vector<float> a, b, c, q;
    std::vector<float> tail;  ///< squares that the coefficients from lane_stride * k on add at least; 0 after the last
};

/// Sums of squares of each lane. Lanes may stop early, together, once all of them must end at `limit` or above.
void box_distances(const SeenThrough& above, const float* low, const float* high, float limit, LaneSums& sums);

/// A homogeneous layer: reflection and transmission by coefficient.
struct LayerRows {
    const float *R, *T;
};
/// Widens the box [low, high] so that it holds the layer over whatever lies in [below_low, below_high].
void widen_box(const LayerRows& layer, const std::vector<float>& below_low, const std::vector<float>& below_high,
               std::vector<float>& low, std::vector<float>& high);

}  // namespace voxtone::scattering
