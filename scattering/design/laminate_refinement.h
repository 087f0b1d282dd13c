// SPDX-License-Identifier: GPL-3.0-or-later
//
// Thicknesses of a laminate, refined between the steps of the search (laminate_search.h; the paper has none of this).
//
// Levenberg and Marquardt's least squares on the same distance, under linear limits: no thickness below 0, their sum
// within thickness_mm, each material as far from the top as clear_top_mm says (kept to 1e-9 mm). A step minimises the
// quadratic model within the limits by Hildreth's method (hildreth.h) and counts only if the distance falls, so the
// result is never worse than what came in. Ceres, which the calibration uses, has bounds on single unknowns but no
// linear inequalities, which the sum and the distances from the top are. Derivatives are exact: to thicken layer j is
// to put a thin one of its material between it and what lies below. With R_j the reflection of all that lies below
// layer j, and T, R' those of the layers down to j,
//
//   dR / dh_j = (S_j (1 - R_j)^2 - 2 K_j R_j) T^2 / (1 - R' R_j)^2
//
// Layers that end at 0 are left out and their neighbours joined where they are alike. What it cannot see: layers that
// are not there, and other minima than the nearest.
#pragma once

#include <span>
#include <vector>

#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

struct RefinedLaminate {
    std::vector<LaminateLayer> layers;
    double distance;  ///< never above distance_before
    double distance_before;
    int steps;       ///< that were taken
    bool converged;  ///< nothing more to gain, as against: stopped by the limit of iterations
};

/// Of the options, thickness_mm, dc_weight, clear_top_mm and backing count. InputError for thicknesses below 0, layers
/// that break the limits by more than 1e-6 mm, profiles of other lengths.
[[nodiscard]] RefinedLaminate refine_laminate(std::span<const LaminateMaterial> materials,
                                              std::span<const LaminateLayer> layers, const ChannelProfiles& target,
                                              const LaminateSearchOptions& options);

}  // namespace voxtone::scattering
