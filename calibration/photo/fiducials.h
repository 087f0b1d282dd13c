// SPDX-License-Identifier: GPL-3.0-or-later
//
// Finds a target in its photograph by its markers, or checks corners that a person gave, and says how sharp the picture
// is.
//
// Three of the four markers are enough. Corners of markers are refined to a fraction of a pixel. Where too few are
// found, the message says what is seen instead: nothing, markers of another target, the mirror image, or light and dark
// exchanged. Cannot see: lens distortion, other than as a residual of the homography.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "calibration/photo/rectify.h"
#include "calibration/target/target_layout.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct TargetView {
    Rectification place;     ///< of the target's coordinates (mm)
    int markers = 0;         ///< found
    double residual_px = 0;  ///< root mean square of the markers' corners about the homography
    double px_per_mm = 0;    ///< in the middle of the target
    double blur_mm = 0;      ///< standard deviation of a Gaussian blur, from the markers' edges
};

/// `corners`: of the slab (not of the markers) in the picture: upper left, upper right, lower right, lower left, as
/// seen with the target the right way up. Throws InputError that says what is wrong and what to try.
[[nodiscard]] TargetView find_target(const io::Photograph& photograph, const Target& target,
                                     const std::optional<std::array<Eigen::Vector2d, 4>>& corners = std::nullopt);

}  // namespace voxtone::calibration
