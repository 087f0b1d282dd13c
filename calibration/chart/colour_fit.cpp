// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/colour_fit.h"

#include <cmath>

#include <ceres/ceres.h>

#include "calibration/chart/chart_data.h"
#include "optics/colour/colour.h"
#include "optics/layered/flat_colour.h"

namespace voxtone::calibration {

namespace {

constexpr double robust_from = 2;  // CIEDE2000
constexpr double ridge = 0.5;

// Derivative of CIELAB's root by XYZ / white.
double root_slope(double t) {
    constexpr double knee = 6.0 / 29;  // CIE 15:2018, 8.2.1
    return t > knee * knee * knee ? 1 / (3 * std::cbrt(t) * std::cbrt(t)) : 1 / (3 * knee * knee);
}

// What all colours share of one set of unknowns is made once for each.
class Preparation : public ceres::EvaluationCallback {
public:
    Preparation(ColourModel& model, const Eigen::VectorXd& unknowns) : model_(model), unknowns_(unknowns) {}
    void PrepareForEvaluation(bool with_derivatives, bool new_point) override {
        if (!new_point && (derived_ || !with_derivatives)) return;
        model_.prepare(unknowns_, with_derivatives);
        derived_ = with_derivatives;
    }

private:
    ColourModel& model_;
    const Eigen::VectorXd& unknowns_;
    bool derived_ = false;
};

class ColourError : public ceres::CostFunction {
public:
    ColourError(const ColourTargets& targets, Eigen::Index row, const ColourModel& model)
        : targets_(targets), row_(row), model_(model) {
        set_num_residuals(3);
        mutable_parameter_block_sizes()->push_back(static_cast<int>(model.unknowns()));
    }
    bool Evaluate(const double* const*, double* residuals, double** jacobians) const override {
        Eigen::Matrix3Xd by(3, model_.unknowns());
        const Eigen::Vector3d colour = model_.colour(row_, by);
        const Eigen::Matrix3d& metric = targets_.metric[static_cast<std::size_t>(row_)];
        const double weight = std::sqrt(targets_.counts[row_]);
        const Eigen::Vector3d off = roots_of(colour) - targets_.roots.row(row_).transpose();
        Eigen::Map<Eigen::Vector3d> out(residuals);
        out = weight * (metric * off);
        if (!jacobians || !jacobians[0]) return true;
        const Eigen::Matrix3d slope = colour.unaryExpr(&root_slope).asDiagonal();
        Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], 3, model_.unknowns()) =
            weight * (metric * slope) * by;
        return true;
    }

private:
    const ColourTargets& targets_;
    Eigen::Index row_;
    const ColourModel& model_;
};

// Few and cheap: their derivatives by central differences.
class OtherErrors : public ceres::CostFunction {
public:
    explicit OtherErrors(const ColourModel& model) : model_(model) {
        set_num_residuals(static_cast<int>(model.others()));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(model.unknowns()));
    }
    bool Evaluate(const double* const* unknowns, double* residuals, double** jacobians) const override {
        constexpr double step = 1e-4;
        const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(unknowns[0], model_.unknowns());
        Eigen::Map<Eigen::VectorXd>(residuals, model_.others()) = model_.other_residuals(at);
        if (!jacobians || !jacobians[0]) return true;
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> by(
            jacobians[0], model_.others(), at.size());
        for (Eigen::Index i = 0; i < at.size(); ++i) {
            Eigen::VectorXd moved = at;
            moved[i] = at[i] + step;
            by.col(i) = model_.other_residuals(moved);
            moved[i] = at[i] - step;
            by.col(i) = (by.col(i) - model_.other_residuals(moved)) / (2 * step);
        }
        return true;
    }

private:
    const ColourModel& model_;
};

class NearUsual : public ceres::CostFunction {
public:
    explicit NearUsual(Eigen::VectorXd usual) : usual_(std::move(usual)) {
        set_num_residuals(static_cast<int>(usual_.size()));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(usual_.size()));
    }
    bool Evaluate(const double* const* unknowns, double* residuals, double** jacobians) const override {
        const Eigen::Index n = usual_.size();
        Eigen::Map<Eigen::VectorXd> out(residuals, n);
        out = ridge * (Eigen::Map<const Eigen::VectorXd>(unknowns[0], n) - usual_);
        if (jacobians && jacobians[0])
            Eigen::Map<Eigen::MatrixXd>(jacobians[0], n, n) = ridge * Eigen::MatrixXd::Identity(n, n);
        return true;
    }

private:
    Eigen::VectorXd usual_;
};

// Looks at every step: whether the user wants to stop, and whether there is still something to gain.
class LookAtSteps : public ceres::IterationCallback {
public:
    explicit LookAtSteps(const Progress* progress) : progress_(progress) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
        constexpr std::size_t looked_at = 25;
        constexpr double gain = 2e-3;
        if (progress_) progress_->check_cancelled();
        costs_.push_back(step.cost);
        if (step.iteration < steps_of_trial || costs_.size() <= looked_at) return ceres::SOLVER_CONTINUE;
        const double before = costs_[costs_.size() - 1 - looked_at];
        return before - step.cost < gain * before ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
    }

private:
    const Progress* progress_;
    std::vector<double> costs_;
};

}  // namespace

Eigen::Vector3d roots_of(const Eigen::Vector3d& relative) {
    return optics::lab_roots(relative, Eigen::Vector3d::Ones());
}

std::vector<double> root_differences(const Eigen::MatrixX3d& predicted, const Eigen::MatrixX3d& measured) {
    const Eigen::Matrix3d map = lab_of_roots();
    const Eigen::Vector3d black(16, 0, 0);
    std::vector<double> differences;
    for (Eigen::Index i = 0; i < predicted.rows(); ++i)
        differences.push_back(
            optics::ciede2000(map * predicted.row(i).transpose() - black, map * measured.row(i).transpose() - black));
    return differences;
}

bool fit_colours(const ColourTargets& targets, ColourModel& model, const Eigen::VectorXd& usual,
                 Eigen::VectorXd& unknowns, const Progress* progress, int most_steps) {
    Preparation preparation(model, unknowns);
    ceres::Problem::Options ownership;
    ownership.evaluation_callback = &preparation;
    ceres::Problem problem(ownership);
    for (Eigen::Index i = 0; i < targets.roots.rows(); ++i)
        problem.AddResidualBlock(new ColourError(targets, i, model), new ceres::SoftLOneLoss(robust_from),
                                 unknowns.data());
    if (model.others() > 0) problem.AddResidualBlock(new OtherErrors(model), nullptr, unknowns.data());
    problem.AddResidualBlock(new NearUsual(usual), nullptr, unknowns.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = most_steps;
    options.function_tolerance = 1e-6;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    LookAtSteps look(progress);
    options.callbacks.push_back(&look);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return summary.termination_type == ceres::CONVERGENCE || summary.termination_type == ceres::USER_SUCCESS;
}

}  // namespace voxtone::calibration
