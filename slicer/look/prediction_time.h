// SPDX-License-Identifier: GPL-3.0-or-later
//
// About how long a prediction takes, for the time that is shown as left (base/job_outlook.h): good to a factor of two
// or three; and the memory that it stays below.
#pragma once

#include <array>
#include <cstddef>

#include "slicer/options/model_choice.h"

namespace voxtone::slicer {

/// Seconds for a surface of this area seen in cells of `quality.cell_mm` and so many channels, and for its white twin.
[[nodiscard]] double prediction_seconds(PredictionModel model, const ModelOptions& quality,
                                        const std::array<double, 3>& pitch_mm, double area_mm2, std::size_t channels);

/// Bytes that the fast predictor takes at the most beside what it is given, for so many cells of the eye: 1.1 to 2.8
/// times what `voxtone predict` took of a photograph of 20 mm and of the bundled cow at 8, 20, 30 and 60 mm.
[[nodiscard]] double prediction_bytes(double cells);

}  // namespace voxtone::slicer
