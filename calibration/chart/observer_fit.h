// SPDX-License-Identifier: GPL-3.0-or-later
//
// Observer and resins of a chart of thick mixtures by least squares (colour_fit.h): every measurement counts once, a
// solid four times.
#pragma once

#include "voxtone/base/progress.h"
#include "voxtone/calibration/chart/chart_data.h"
#include "voxtone/calibration/chart/observer_model.h"

namespace voxtone::calibration {

struct ObserverFit {
    ObserverParts parts;
    Eigen::MatrixX3d roots;  ///< predicted of the mixtures that were fitted
    bool converged = false;
};

/// From observer_start.h, exact derivatives.
[[nodiscard]] ObserverFit fit_observer(const ChartData& data, const ObserverModel& model, const ObserverParts& start,
                                       const Progress* progress = nullptr);

/// Roots that a model predicts of mixtures.
[[nodiscard]] Eigen::MatrixX3d predicted_roots(const ObserverModel& model, const ObserverParts& parts,
                                               const Eigen::MatrixXd& shares);

}  // namespace voxtone::calibration
