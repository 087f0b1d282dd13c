// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where contrast before level matters: how much of the target's fine contrast a print loses, place by place.
//
//   t, p      Oklab's lightness of target and print behind the eye's narrowest Gaussian (eye_filter.h), each less its
//   mean S over a millimetre l_i       = max(0, S(t (t - p))_i / sqrt(S(t^2))_i):  what the print has not got of the
//   contrast sqrt(S(t^2));
//             light and dark that the target knows nothing of do not count
//   u         = S S l:  whoever stands near gives light to what loses contrast, or takes it
//   k_i       = most * u_i^2 / (u_i^2 + s^2),   s = 0.03
//
// k is the part of a neighbourhood's lightness that misfit.h lets go for the sake of contrast. With the same k
// everywhere, levels give way where there is nothing to be had for it: dark pictures, whose contrast is small, stayed
// too light by six units of L*. Black type on white loses a u of 0.05 to 0.1 in the open loop, dark marble less than
// 0.01. (most, s) were chosen on the fitting set: docs/decisions/004.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/eye_filter.h"

namespace voxtone::halftone {

/// u per cell, in Oklab's lightness (0 to 1), of what that Gaussian leaves of target and print, linear sRGB. `wide`:
/// gives S.
[[nodiscard]] std::vector<float> lost_contrast(std::span<const Eigen::Vector3f> near_target,
                                               std::span<const Eigen::Vector3f> near, const EyeFilter& wide);

struct FineContrast {
    float wanted = 0;  ///< sqrt(S(t^2)): of the target, in Oklab's lightness
    float kept = 1;    ///< S(t p) / S(t^2): the part of it that the print has
};
[[nodiscard]] std::vector<FineContrast> fine_contrast(std::span<const Eigen::Vector3f> near_target,
                                                      std::span<const Eigen::Vector3f> near, const EyeFilter& wide);

/// k per cell; `most` in [0, 1].
[[nodiscard]] std::vector<float> contrast_parts(std::vector<float> lost, float most);

}  // namespace voxtone::halftone
