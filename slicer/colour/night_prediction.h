// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a slab with colours on its lower face (layers/night_side.h) shows by light from behind, beside what was asked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/report/report.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/layers/night_side.h"
#include "slicer/options/model_choice.h"

namespace voxtone::slicer {

struct NightPrediction {
    SurfacePrediction predicted;          ///< its colours over `level`: an eye takes a lamp's light for white
    std::vector<Eigen::Vector3f> target;  ///< per cell
    double level = 1;                     ///< white as it is seen, of what clear resin alone lets through
    double seen_mean = 0;                 ///< CIEDE2000 from the viewing distance
    double beyond = 0;                    ///< share of the picture that asks for more light than the day leaves

    /// What the night gave up, in a sentence.
    [[nodiscard]] std::string words() const;
};

/// `print`: of the day; its volume is lent and comes back. Throws what the model throws.
[[nodiscard]] NightPrediction predict_night(const ResolvedJob& job, PredictionModel model, const JobBody& body,
                                            const LoadedResins& resins, const NightSide& night, JobPrediction& print,
                                            Progress& progress);

/// Writes its pictures into the folder, and a section for the page.
[[nodiscard]] io::ReportSection draw_night(const NightPrediction& night, const JobPrediction& print,
                                           const std::filesystem::path& folder);

}  // namespace voxtone::slicer
