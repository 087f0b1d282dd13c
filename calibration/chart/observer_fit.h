// SPDX-License-Identifier: GPL-3.0-or-later
//
// Observer and resins of a chart by least squares in the eye's own metric:
//
//   minimise sum_i n_i L(|W_i (lab roots of colour_i(u) - measured roots_i)|^2) + lambda^2 |u - u_0|^2
//
// |W d| is CIEDE2000 of a small difference, L(s) = 2 b^2 (sqrt(1 + s / b^2) - 1) with b = 2 CIEDE2000, so that a few
// wrong patches do not bend the rest, u_0 the start (observer_start.h), lambda = 1/2: a factor e^2 in an absorption
// counts as much as a patch that is off by 1. Levenberg-Marquardt (Ceres), exact derivatives; the same bits for any
// number of threads.
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

[[nodiscard]] ObserverFit fit_observer(const ChartData& data, const ObserverModel& model, const ObserverParts& start,
                                       const Progress* progress = nullptr);

/// Roots that a model predicts of mixtures.
[[nodiscard]] Eigen::MatrixX3d predicted_roots(const ObserverModel& model, const ObserverParts& parts,
                                               const Eigen::MatrixXd& shares);

/// CIEDE2000 between roots, row by row: the real one, not the metric.
[[nodiscard]] std::vector<double> root_differences(const Eigen::MatrixX3d& predicted, const Eigen::MatrixX3d& measured);

}  // namespace voxtone::calibration
