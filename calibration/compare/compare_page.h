// SPDX-License-Identifier: GPL-3.0-or-later
//
// A comparison to look at: one HTML page that needs nothing else, with the photograph straightened, the prediction
// (a slider between them), the difference behind the eye's filter, what it comes of, and the worst places.
#pragma once

#include <string>
#include <vector>

#include "calibration/compare/print_difference.h"

namespace voxtone::calibration {

[[nodiscard]] std::string compare_page(const PredictedPrint& print, const std::vector<PrintReading>& readings,
                                       const PrintDifference& difference, double viewing_distance_mm);

/// In one line.
[[nodiscard]] std::string difference_words(const PrintDifference& difference, double viewing_distance_mm);
/// What is told of one photograph.
[[nodiscard]] std::string reading_words(const PrintReading& reading, const PredictedPrint& print);

inline constexpr std::size_t shown_tiles = 8;

}  // namespace voxtone::calibration
