// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which one resin's extinction, were it another, would explain what is left between a print and its prediction.
//
// Regions of the print are the samples: y = mean over a region of ln(seen / by light paths), by channel of linear sRGB.
//   y_tc = k_c + light(place) + sum_r delta_r s_rtc + error,    s = d ln rgb / d ln extinction (print_regions.h)
//
// k_c is what exposure and white balance leave, light what the field of light does. All resins at once, each as far off
// as resins usually are; one of them may be far off. How much more likely the regions are then, the changes and the
// noise integrated out, is the evidence against that one: it is named where the evidence is ten times that of any other
// and of none. Cannot see: wrong albedos, other than as a wrong extinction; two resins that are off (refit.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/compare/print_regions.h"

namespace voxtone::calibration {

/// Of a tile; one entry of `by_extinction` for each resin.
struct ResinSample {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< in [-1, 1] over the print
    Eigen::Vector3d log_ratio = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> by_extinction;
    double weight = 1;
};

struct ResinHint {
    double change = 0;     ///< of the extinction, relative: 0.1 is ten percent more than the set has
    double error = 0;      ///< its standard error
    double explained = 0;  ///< share of the squares
};

struct ResinHints {
    std::vector<ResinHint> resins;
    std::optional<std::size_t> named;
};

[[nodiscard]] ResinHints hint_at_resins(std::span<const ResinSample> samples, std::size_t resins);

}  // namespace voxtone::calibration
