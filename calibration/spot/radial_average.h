// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean of a picture round a point, as a profile of samples at even distances with straight lines between them.
//
// Least squares: the profile that is nearest to all pixels, each at the distance of its middle, pixels alike. That is
// the average over rings for profiles that are used as straight lines between samples (HankelGrid::from_even): a
// profile that is made of such lines comes back exactly, any other one with the same light in every sample's tent, so
// totals are right although samples are far apart.
//
// Errors: a pixel's variance is what the merge says it is times how much pixels within rings truly scatter, taken from
// the `pooled_pixels` pixels nearest to the ring at least; through the normal equations to samples (covariance N^-1 M
// N^-1). So noise that is larger than the camera is said to have, dust and a spot that is not quite round count. What
// all pixels of a ring have in common (stray light, a blur) does not, and noise is taken as independent from pixel to
// pixel: a picture interpolated from a sensor's colour filters has less news than pixels.
#pragma once

#include <vector>

#include "calibration/spot/ring_pixels.h"

namespace voxtone::calibration {

inline constexpr std::size_t pooled_pixels = 200;

/// The profile only, full scale per second. Contract: the rules of RadialPlan. Throws InputError where more than a
/// fifth of the pixels between two samples are saturated in every exposure.
[[nodiscard]] std::vector<double> fit_rings(const MergedPicture& picture, int channel, const RadialPlan& plan);

struct RadialProfile {
    std::vector<double> light, error;  ///< per sample, scaled to the total
    double scale = 0;                  ///< what full scale per second was multiplied by, 1 / (mm^2 full scale / s)
    double scale_error = 0;            ///< relative standard error of it; part of `error`
    double noise =
        0;  ///< how much pixels scatter within rings, as a part of what the camera's noise says (roots of mean squares)
    double asymmetry =
        0;  ///< root of mean square of eighths of rings about their ring, noise taken off, / that of the profile
    std::size_t missing = 0;
};

/// The profile with its errors, scaled so that the light of straight lines between samples sums up to `total` (> 0)
/// over the plane. Throws InputError also where there is no light.
[[nodiscard]] RadialProfile average_rings(const MergedPicture& picture, int channel, const RadialPlan& plan,
                                          double total);

}  // namespace voxtone::calibration
