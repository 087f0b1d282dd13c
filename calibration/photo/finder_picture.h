// SPDX-License-Identifier: GPL-3.0-or-later
//
// A photograph as finders of markers and charts want it: 8 bits, brightened so that dark raw pictures show what is in
// them.
#pragma once

#include <cstdint>
#include <vector>

#include "io/pictures/photograph.h"

namespace voxtone::calibration {

/// Blue, green, red of each pixel: each channel scaled to its own 99.5th percentile, and the square root taken where
/// the samples are linear. Neutral enough for finders.
[[nodiscard]] std::vector<std::uint8_t> finder_bgr(const io::Photograph& photograph);
/// Mean of the three.
[[nodiscard]] std::vector<std::uint8_t> finder_grey(const io::Photograph& photograph);

}  // namespace voxtone::calibration
