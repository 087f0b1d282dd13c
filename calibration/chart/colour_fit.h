// SPDX-License-Identifier: GPL-3.0-or-later
//
// Least squares of measured colours in the eye's own metric, whatever predicts them:
//
//   minimise sum_i L(n_i |W_i (f(colour_i(u)) - roots_i)|^2) + sum_j o_j(u)^2 + lambda^2 |u - u_0|^2
//
// colour_i is XYZ / white, f CIELAB's root, |W d| is CIEDE2000 of a small difference d of roots, n_i how much a colour
// counts, L(s) = 2 b^2 (sqrt(1 + s / b^2) - 1) with b = 2 CIEDE2000, so that a few wrong patches do not bend the rest,
// o_j what is known besides,
// u_0 what is usual, lambda = 1/2: a factor e^2 in an absorption counts as much as a patch that is off by 1.
// Levenberg-Marquardt (Ceres); the same bits for any number of threads.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "base/progress.h"

namespace voxtone::calibration {

struct ColourTargets {
    Eigen::MatrixX3d roots;
    std::vector<Eigen::Matrix3d> metric;  ///< W of each
    Eigen::VectorXd counts;               ///< n of each, > 0
};

/// What predicts the colours.
class ColourModel {
public:
    virtual ~ColourModel() = default;
    [[nodiscard]] virtual Eigen::Index unknowns() const = 0;
    /// Called before colours of these unknowns are asked for.
    virtual void prepare(const Eigen::VectorXd& unknowns, bool with_derivatives) = 0;
    /// XYZ / white of target `row`, and its derivatives by the unknowns where `prepare` was told so.
    [[nodiscard]] virtual Eigen::Vector3d colour(Eigen::Index row, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const = 0;
    /// What is known besides: so many residuals, in standard errors, and their values.
    [[nodiscard]] virtual Eigen::Index others() const { return 0; }
    [[nodiscard]] virtual Eigen::VectorXd other_residuals(const Eigen::VectorXd&) const { return {}; }
};

/// Steps of a fit that is one of many; those of one that is kept.
inline constexpr int steps_of_trial = 100, steps_of_result = 2000;

/// From `unknowns` to the best near `usual`; false where they did not come to rest within so many steps. At rest they
/// are where a step gains less than 1e-6 of the sum, and, after `steps_of_trial` steps, where the last 25 gained less
/// than 2e-3 of it: 0.1 % of the differences. Throws Cancelled.
bool fit_colours(const ColourTargets& targets, ColourModel& model, const Eigen::VectorXd& usual,
                 Eigen::VectorXd& unknowns, const Progress* progress = nullptr, int most_steps = steps_of_trial);

/// CIELAB's roots of XYZ / white.
[[nodiscard]] Eigen::Vector3d roots_of(const Eigen::Vector3d& relative);

/// CIEDE2000 between roots, row by row: the real one, not the metric.
[[nodiscard]] std::vector<double> root_differences(const Eigen::MatrixX3d& predicted, const Eigen::MatrixX3d& measured);

}  // namespace voxtone::calibration
