// SPDX-License-Identifier: GPL-3.0-or-later
//
// A prediction as files, and as it is told.
#pragma once

#include <string>

#include "base/progress.h"
#include "slicer/predict/predicted_stack.h"

namespace voxtone::slicer {

/// All files that were asked for. Throws FileError, InputError.
void write_prediction(const ResolvedPrediction& job, const PredictedStack& predicted, const PredictFigures& figures,
                      const Progress& progress);

/// The mean colour and the errors.
void add_means(const SurfacePrediction& prediction, PredictFigures& figures);

struct PredictResult {
    std::string json;  ///< one JSON object, "format": "voxtone-prediction"
    std::string text;  ///< a few lines for a person
};
[[nodiscard]] PredictResult describe(const ResolvedPrediction& job, const PredictedStack& predicted,
                                     const PredictFigures& figures);

}  // namespace voxtone::slicer
