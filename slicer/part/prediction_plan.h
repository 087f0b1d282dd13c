// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a job predicts its print, and by what.
#pragma once

#include <string>

#include "slicer/options/model_choice.h"
#include "slicer/part/job_body.h"
#include "slicer/part/opened_job.h"

namespace voxtone::slicer {

/// What a job predicts, known before its layers are made.
struct PredictionPlan {
    enum class By {
        nothing,
        loop,   ///< what comes out of the appearance loop at no further cost
        model,  ///< `model`
    };
    By by = By::nothing;
    PredictionModel model = PredictionModel::transport;
    std::string why_not;     ///< where nothing: a sentence for the report; may be empty
    bool last_look = false;  ///< of `loop`: it looks once more, at the print that it comes to, as well as `model` would
};

/// The model that was asked for; or none; or, automatic: the default model up to auto_prediction_cm2 of coloured
/// surface, above that what the appearance loop predicted, if there was one (`looped`). A loop whose cells are those
/// that the default model would take (not where voxels are apart, which it cuts cells for) looks once more in its
/// place. A part of the layers is never predicted, nor is a job without a report, nor, without being asked, white
/// beside white (`all_white`).
[[nodiscard]] PredictionPlan plan_prediction(const OpenedJob& job, const JobBody& body, bool all_layers, bool looped,
                                             bool all_white);

}  // namespace voxtone::slicer
