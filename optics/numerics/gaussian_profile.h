// SPDX-License-Identifier: GPL-3.0-or-later
//
// A reflection profile as a sum of a few Gaussians of fixed widths:
//
//   P(r) = sum_j w_j exp(-r^2 / u_j^2) / (pi u_j^2),   P^(kappa) = sum_j w_j exp(-(kappa u_j / 2)^2),   w_j >= 0
//
// Light that diffuses is such a sum: of Gaussians that widen with the time it took, u^2 = 4 D t, weighted by the light
// that comes out at that time; w_j is a coarse histogram of it. It is found from P^ at a few waves by least squares
// with w_j >= 0 and a penalty on its third differences in ln u, which chooses the smoothest of the many histograms that
// differ below 1e-3 in P^ (weights of two profiles are comparable then: products of their roots need that). At last all
// are scaled so that they add up to P^(0) exactly.
//
// Range: 0.05 to 5 mm; what is narrower or wider goes to the end.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace voxtone::optics {

inline constexpr int profile_waves = 12;
using Waves = Eigen::Array<float, profile_waves, 1>;

inline constexpr std::size_t profile_gaussians = 8;
using GaussianWeights = std::array<float, profile_gaussians>;

/// u_j, mm, ascending by a constant ratio.
[[nodiscard]] const std::array<double, profile_gaussians>& gaussian_widths_mm();
/// kappa = 2 pi k, rad/mm, ascending; the first is 0.
[[nodiscard]] const Waves& wave_numbers();

/// Of the profile with these P^ at `wave_numbers`; P^(0) >= 0.
[[nodiscard]] GaussianWeights gaussian_weights(const Waves& profile);

}  // namespace voxtone::optics
