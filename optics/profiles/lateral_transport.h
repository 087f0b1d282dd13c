// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light that enters a heterogeneous surface at one place and leaves at another, by local profiles.
//
// The response of two places of an index-matched body is the geometric mean of their profiles (Song et al. 2009; Hasan
// et al. 2010, Eq. 7). With profiles as sums of Gaussians of the same widths (gaussian_profile.h) the root is taken
// weight by weight, which is exact where profiles differ in brightness only; light d that goes down comes up as
//
//   (R d)(x) = integral of sqrt(P(x, r) P(x', r)) d(x') dx' = sum_j sqrt(w_j(x)) (G_j * (sqrt(w_j) d))(x)
//
// one smoothing over the surface for each width. A smooth surface turns back its share s of that, which goes down again
// at the place where it came up, so of uniform light is seen
//
//   appearance = (1 - s) R d,   d = 1 + s R d
//
// solved by Chebyshev's iteration from what each place would have by itself: a surface that is the same everywhere
// shows (1 - s) w / (1 - s w), w = sum_j w_j. (Eq. 7 knows both ends of a way and nothing between; with all bounces in
// P, as if no surface were there, patches of a millimetre come out much too bright.)
//
// Where profiles differ in width light is missing (sqrt(P P') is below the mean of both). Nothing keeps R below 1 where
// many widths meet; the answer ends there. Error of the iteration: below 0.002.
//
// Cells average what is finer: a Gaussian of spread u between cells of edge p moves light by a mean square of u^2 / 2 +
// p^2 / 6 per axis, or p u / (2 sqrt(pi)) where u < 0.56 p, when only neighbours exchange light; smoothing is by as
// much.
//
// Who is seen together, and borders: gaussian_gather.h. Light does not pass around the edge of a box, nor from side to
// side.
#pragma once

#include <span>
#include <vector>

#include "optics/numerics/gaussian_profile.h"
#include "optics/scene/surface_smoothing.h"

namespace voxtone::optics {

/// `weights[point * channels + channel]`, >= 0, at most 1 in all for each; 0 <= turned_back < 1. Answers in the same
/// order. Same bits for any number of threads.
[[nodiscard]] std::vector<float> with_lateral_transport(std::span<const SurfacePoint> points,
                                                        std::span<const GaussianWeights> weights, std::size_t channels,
                                                        double turned_back);

}  // namespace voxtone::optics
