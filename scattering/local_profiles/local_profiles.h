// SPDX-License-Identifier: GPL-3.0-or-later
//
// The scattering profile that each point of a heterogeneous surface has by itself: R(x_i, x_o) factored into P(x, r).
// Based on: Y. Song, X. Tong, F. Pellacini, P. Peers, "SubEdit: a representation for editing measured heterogeneous
// subsurface scattering", SIGGRAPH 2009, as used by Hasan et al. 2010, Sec. 7.1, Eq. 7:
//
//   R(x_i, x_o) = sqrt(P(x_i, r) P(x_o, r)),   r = |x_i - x_o|
//
// With logarithms this is linear: ln R = (p(x_i, r) + p(x_o, r)) / 2, p = ln P at knots (profile_rings.h). The paper
// solves it as a regularised sparse least-squares problem. Responses of few counts cannot be put under a logarithm:
// those of zero have none, and the mean of a logarithm is not the logarithm of the mean. So the same linear model is
// fitted to the counts themselves (Poisson regression with a logarithmic link; P. McCullagh, J. A. Nelder, "Generalized
// linear models", 2nd ed. 1989, Ch. 6):
//
//   minimise  sum over pairs (R' - R ln R') / noise  +  sum over points and knots (p'' )^2 / (2 curvature^2)
//
// with R' the model and p'' the second difference along r. It is convex; each of Newton's steps is the regularised
// sparse least-squares problem in logarithms, with weights R' / noise: the certainty of a count. Zeros count as what
// they are. At the minimum the model's light in every ring around every point is the data's, but for the pull of
// smoothness: light is kept.
//
// All that counts of the data is therefore its light by point and knot; R' factors into images sqrt(P(., r)), one per
// distinct r, and each product with the matrix is a sum over rings. No pair is ever held as a matrix entry. Conjugate
// gradients (conjugate_gradient.h) with the exact block of each point as preconditioner (K x K, five bands).
//
// Time: 256 x 256 points, radius 10: docs/heterogeneous.md. Memory: 16 bytes x points x (rings + 7 knots). The same
// bits for any number of threads. Where a ring has few counts P is noisy, and its mean over points too bright, although
// R' is not: take means of roots (profile_clusters.h). What it cannot see: R that depends on direction, or on the way
// between two points (an edge that parts them).
#pragma once

#include <cstddef>
#include <vector>

#include "base/progress.h"
#include "optics/monte_carlo/sampled_bssrdf.h"
#include "scattering/local_profiles/profile_rings.h"

namespace voxtone::scattering {

struct LocalProfileOptions {
    /// Second differences of ln P from knot to knot have about this standard deviation; above 0. Smaller is smoother.
    double curvature = 0.5;
    /// Stop when the light by point and knot differs from what the minimum asks by this share of all light.
    double tolerance = 1e-4;
    int max_steps = 40;        ///< of Newton
    int max_iterations = 200;  ///< of conjugate gradients, in a step
    void validate() const;     ///< throws InputError that names the value and the rule it breaks
};

/// Of one channel: P [knot][point], mm^-2.
using ProfileImages = std::vector<double>;

struct LocalProfiles {
    PointGrid grid;
    std::uint32_t radius = 0;  ///< knots at 0, 1, ..., radius points
    double pitch_mm = 0;
    std::vector<ProfileImages> channels;
    [[nodiscard]] std::size_t knots() const { return std::size_t{radius} + 1; }
};

/// Of one channel.
struct FactorSummary {
    int steps = 0, iterations = 0;  ///< of Newton; of conjugate gradients in all
    double residual = 1;            ///< what `tolerance` is held against
    bool converged = false;
};

/// Throws InputError where a channel holds no light at all. `progress` advances once a channel.
[[nodiscard]] LocalProfiles factor_responses(const optics::SampledBssrdf& responses, const LocalProfileOptions& options,
                                             std::vector<FactorSummary>& summary, Progress* progress = nullptr);

}  // namespace voxtone::scattering
