// SPDX-License-Identifier: GPL-3.0-or-later
//
// The point of a picture about which it is most alike in all directions, to a small part of a pixel.
//
// Begins at the middle of the light above half of the highest, in the picture blurred by 2 px, and goes by Gauss-Newton
// to where pixels scatter least about the profile of rings (radial_average.h): a picture that is off by d differs from
// its profile by -f'(r) cos(angle to d) d. All channels count, by their noise: one centre for all.
#pragma once

#include <Eigen/Core>

#include "calibration/spot/exposure_merge.h"

namespace voxtone::calibration {

struct RadialCentre {
    Eigen::Vector2d px;        ///< the middle of the first pixel is at (0.5, 0.5)
    Eigen::Vector2d error_px;  ///< standard error, from the scatter of pixels within rings
    int steps = 0;
};

/// Rings as wide as `spacing_px`, up to `reach_px` or the nearest border. Throws InputError where no light is above the
/// noise, pixels of the spot are saturated in every exposure, fewer than 16 rings fit between centre and border, or no
/// centre is found.
[[nodiscard]] RadialCentre find_radial_centre(const MergedPicture& picture, double spacing_px, double reach_px);

/// How far the nearest border is.
[[nodiscard]] double border_distance_px(const MergedPicture& picture, const Eigen::Vector2d& centre_px);

}  // namespace voxtone::calibration
