// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light that enters a heterogeneous surface at one place and leaves at another, by local profiles.
//
// The response of two places is the geometric mean of their profiles (Song et al. 2009; Hasan et al. 2010, Eq. 7), so of a surface
// in uniform light is seen
//
//   appearance(x) = integral of sqrt(P(x, r) P(x', r)) dx',   r = |x - x'|
//
// With profiles as sums of Gaussians of the same widths (gaussian_profile.h) the root is taken weight by weight, which is exact
// where profiles differ in brightness only:
//
//   appearance(x) = sum_j sqrt(w_j(x)) (G_j * sqrt(w_j))(x)
//
// one smoothing over the surface for each width. A surface that is the same everywhere shows its total. It is exact for a filter
// of any pattern on an even base: light passes it twice, at two places. Where profiles differ in width light is missing
// (sqrt(P P') is below the mean of both), and it can be above 1, where it ends.
//
// Cells average what is finer: a Gaussian of spread u between cells of edge p moves light by a mean square of u^2 / 2 + p^2 / 6 per
// axis, or p u / (2 sqrt(pi)) where u < 0.56 p, when only neighbours exchange light; smoothing is by as much.
//
// Who is seen together, and borders: gaussian_gather.h. Light does not pass around the edge of a box, nor from side to side.
#pragma once

#include <span>
#include <vector>

#include "voxtone/optics/gaussian_profile.h"
#include "voxtone/optics/surface_smoothing.h"

namespace voxtone::optics {

/// `weights[cell * channels + channel]`, >= 0, at most 1 in all for each. Same bits for any number of threads.
[[nodiscard]] std::vector<float> with_sideways_light(std::span<const SurfacePoint> points, std::span<const GaussianWeights> weights,
                                                     std::size_t channels);

}  // namespace voxtone::optics
