// SPDX-License-Identifier: GPL-3.0-or-later
//
// Observer and resins of a chart by least squares (colour_fit.h), thick mixtures and the squares that tell lengths at
// once: every measurement counts once, a solid four times.
#pragma once

#include "base/progress.h"
#include "calibration/chart/chart_data.h"
#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_model.h"

namespace voxtone::calibration {

struct ObserverFit {
    ObserverParts parts;
    Eigen::MatrixX3d roots;         ///< predicted of the mixtures that were fitted
    Eigen::MatrixX3d square_roots;  ///< of the squares
    bool converged = false;
};

/// Near `start` (observer_start.h), whose scattering and dot spread hold where they are not fitted; it begins there, or
/// at `from`. Laminates begin at `start` and at clearer resins, and the nearer of the two fits is kept. Exact
/// derivatives.
[[nodiscard]] ObserverFit fit_observer(const ChartData& data, const ObserverModel& model, const ObserverParts& start,
                                       const Progress* progress = nullptr, int most_steps = steps_of_trial,
                                       const ObserverParts* from = nullptr);

/// Roots that a model predicts of mixtures.
[[nodiscard]] Eigen::MatrixX3d predicted_roots(const ObserverModel& model, const ObserverParts& parts,
                                               const Eigen::MatrixXd& shares);

}  // namespace voxtone::calibration
