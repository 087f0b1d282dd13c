// SPDX-License-Identifier: GPL-3.0-or-later
//
// One prediction from a layer stack to pictures or meshes of what a person will see: resolve, read, predict, write.
#pragma once

#include "base/progress.h"
#include "slicer/predict/predicted_stack.h"
#include "slicer/predict/prediction_options.h"
#include "slicer/predict/prediction_writer.h"

namespace voxtone::slicer {

/// A slab's, for those who go on with it: writes nothing, and asks for no files. Throws Error (with its exit code).
[[nodiscard]] PredictedStack predict_from_above(const PredictOptions& options, PredictFigures& figures,
                                                Progress& progress);
/// The same of a body too: `figures.from_above` says which it is.
[[nodiscard]] PredictedStack predict_slab_or_body(const PredictOptions& options, PredictFigures& figures,
                                                  Progress& progress);

/// Throws Error (with its exit code); then none of the files was written, or those that were are whole.
PredictResult run_predict_job(const PredictOptions& options, Progress& progress);

}  // namespace voxtone::slicer
