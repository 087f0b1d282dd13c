// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/prediction_plan.h"

#include <fmt/core.h>

#include "optics/grid/block_contrast.h"
#include "slicer/look/coarse_cells.h"
#include "slicer/options/auto_limits.h"

namespace voxtone::slicer {

namespace {

bool sees_as_well(const OpenedJob& job, const JobBody& body) {
    const Eigen::Vector3d& pitch = body.grid.pitch_mm;
    return job.options.loop.model == PredictionModel::transport && !job.options.picture.is_lit_from_behind() &&
           !optics::voxels_are_apart(job.resins.set) &&
           !coarse_cells({pitch.x(), pitch.y(), pitch.z()}, job.options.prediction.cell_mm);
}

}  // namespace

PredictionPlan plan_prediction(const OpenedJob& job, const JobBody& body, bool all_layers, bool looped,
                               bool all_white) {
    using By = PredictionPlan::By;
    const JobPredictionOptions& options = job.options.prediction;
    if (!job.options.report || (!options.automatic && !options.model)) return {};
    if (!job.run.why_unpredicted.empty()) return {.why_not = job.run.why_unpredicted};
    if (!all_layers) return {.why_not = "Only a part of the layers was made: a part is not predicted."};
    if (options.model) return {.by = By::model, .model = *options.model, .why_not = ""};
    const double area_mm2 = coloured_area_mm2(*body.surface);
    const bool small = area_mm2 <= 100 * auto_prediction_cm2;
    // White beside white: the answer is known.
    if (small && all_white)
        return {.why_not = "The print is all of white resin: it is as white as was asked for everywhere."};
    if (small && !(looped && sees_as_well(job, body))) return {.by = By::model, .why_not = ""};
    if (looped) return {.by = By::loop, .why_not = "", .last_look = small};
    return {.why_not =
                fmt::format("The coloured surface has {:.0f} cm2; more than {:g} cm2 are not predicted without being "
                            "asked: --predict {}.",
                            area_mm2 / 100, auto_prediction_cm2, name_of(PredictionModel::transport))};
}

}  // namespace voxtone::slicer
