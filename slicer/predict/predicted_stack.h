// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stack read, and predicted: what is refused of it, from where and over what it is seen, its cells, its model.
#pragma once

#include <array>

#include "base/progress.h"
#include "slicer/look/surface_prediction.h"
#include "slicer/options/option_words.h"
#include "slicer/predict/prediction_options.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::slicer {

struct PredictFigures {
    BackingChoice backing{};
    bool from_behind = false;  ///< lit from there alone
    BodyEnd boundary = BodyEnd::voxels;
    bool from_above = false;
    std::array<double, 3> cell_um{};
    std::array<double, 3> mean{};
    double mean_error = 0, largest_error = 0;
    double read_s = 0, surface_s = 0, predict_s = 0, write_s = 0;
};

/// A stack, and what its print will look like.
struct PredictedStack {
    StackVolume stack;
    SurfacePrediction prediction;
};

/// `figures`: all but the time of writing and the means. Throws Error (with its exit code).
[[nodiscard]] PredictedStack predict_stack(const ResolvedPrediction& job, PredictFigures& figures, Progress& progress);

}  // namespace voxtone::slicer
