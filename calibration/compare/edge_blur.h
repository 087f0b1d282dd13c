// SPDX-License-Identifier: GPL-3.0-or-later
//
// How sharp a photograph is at a print's outline, where a sharp edge stands against the ground: what a camera and the
// rounding of that edge do, as one Gaussian.
#pragma once

#include <optional>

#include "calibration/compare/print_place.h"

namespace voxtone::calibration {

/// Standard deviation in pixels: 25 % to 75 % of a Gaussian's edge are 1.349 of them; the median of the four sides.
/// Nothing where the print hardly differs from the ground there.
[[nodiscard]] std::optional<double> edge_blur_px(const io::Photograph& photograph, const PrintPlace& place);

}  // namespace voxtone::calibration
