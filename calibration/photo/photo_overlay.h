// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture of what was sampled in a photograph, for a person to check: the photograph after the colour correction and
// without its uneven light, with the sampled parts of squares (green, numbered), of the frame (blue) and of the chart
// (white) drawn in. Dirtier squares are drawn in red.
#pragma once

#include "calibration/photo/photo_measurement.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::calibration {

[[nodiscard]] io::Picture8 photo_overlay(const PhotoMeasurement& measurement, const CheckerChart& chart,
                                         int longest_px = 1600);

}  // namespace voxtone::calibration
