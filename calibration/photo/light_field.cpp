// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/light_field.h"

#include <algorithm>
#include <cmath>

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <Eigen/LU>

#include "base/contracts.h"
#include "base/error.h"
#include "optics/numerics/dense.h"

namespace voxtone::calibration {

namespace {

constexpr int terms = PhotoModel::light_terms;
using Basis = Eigen::Matrix<double, terms, 1>;

/// Standard deviations of the light's terms before anything is seen; lengths in half diagonals of the picture.
const double prior[terms] = {0.5, 0.5, 0.3, 0.3, 0.3, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2};

template <class T>
T light_of(const Basis& basis, const T* light) {
    T sum = T(0);
    for (int k = 0; k < terms; ++k) sum += basis[k] * light[k];
    using std::exp;
    return exp(sum);
}

struct ChartCost {
    Basis basis;
    Eigen::Vector3d value, reference, deviation;
    template <class T>
    bool operator()(const T* M, const T* light, T* residual) const {
        const T L = light_of(basis, light);
        for (int i = 0; i < 3; ++i)
            residual[i] =
                (L * (M[3 * i] * reference[0] + M[3 * i + 1] * reference[1] + M[3 * i + 2] * reference[2]) - value[i]) /
                deviation[i];
        return true;
    }
};

struct FrameCost {
    Basis basis;
    Eigen::Vector3d value, deviation;
    template <class T>
    bool operator()(const T* white, const T* light, T* residual) const {
        const T L = light_of(basis, light);
        for (int i = 0; i < 3; ++i) residual[i] = (L * white[i] - value[i]) / deviation[i];
        return true;
    }
};

struct PriorCost {
    template <class T>
    bool operator()(const T* light, T* residual) const {
        for (int k = 0; k < terms; ++k) residual[k] = light[k] / prior[k];
        return true;
    }
};

/// A chart's patches are wrong partly by a share of themselves, partly by a share of white.
Eigen::Vector3d chart_deviation(const Eigen::Vector3d& value, const Eigen::Vector3d& white) {
    return 0.5 * value + 0.1 * white;
}

}  // namespace

Basis PhotoModel::basis(const Eigen::Vector2d& px) const {
    const Eigen::Vector2d middle(width_px_ / 2, height_px_ / 2);
    const Eigen::Vector2d u = (px - middle) / middle.norm();
    const double x = u.x(), y = u.y(), r2 = u.squaredNorm();
    Basis b;
    b << x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y, r2 * r2, r2 * r2 * r2;
    return b;
}

PhotoModel PhotoModel::fit(std::span<const LitSample> chart, std::span<const LitSample> frame, double width_px,
                           double height_px, const std::string& name) {
    constexpr std::size_t least_patches = 12, least_frame = 8;
    if (chart.size() < least_patches)
        throw InputError(
            fmt::format("{}: only {} patches of the colour checker can be used, {} are needed; the others clip or are "
                        "cut off: expose less, show all of it",
                        name, chart.size(), least_patches));
    if (frame.size() < least_frame)
        throw InputError(
            fmt::format("{}: only {} places of the light frame can be used, {} are needed; it clips, is cut off or is "
                        "too small in the picture",
                        name, frame.size(), least_frame));
    PhotoModel model;
    model.width_px_ = width_px;
    model.height_px_ = height_px;
    Eigen::MatrixXd from(chart.size(), 3), to(chart.size(), 3);
    Eigen::Vector3d chart_white = Eigen::Vector3d::Zero(), frame_mean = Eigen::Vector3d::Zero();
    for (std::size_t p = 0; p < chart.size(); ++p) {
        from.row(Eigen::Index(p)) = chart[p].reference.transpose();
        to.row(Eigen::Index(p)) = chart[p].value.transpose();
        chart_white = chart_white.cwiseMax(chart[p].value);
    }
    for (const LitSample& sample : frame) frame_mean += sample.value / double(frame.size());
    Parameters& theta = model.theta_;
    const Eigen::Matrix3d M = optics::least_squares(from, to).transpose();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) theta[3 * i + j] = M(i, j);
    theta.segment<3>(9) = frame_mean;

    double chart_scale = 0.02, frame_scale = 0.01;
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
        ceres::Problem problem;
        double* const blocks[] = {theta.data(), theta.data() + 9, theta.data() + 12};
        for (const LitSample& s : chart)
            problem.AddResidualBlock(
                new ceres::AutoDiffCostFunction<ChartCost, 3, 9, terms>(new ChartCost{
                    model.basis(s.px), s.value, s.reference, chart_scale * chart_deviation(s.value, chart_white)}),
                nullptr, blocks[0], blocks[2]);
        for (const LitSample& s : frame)
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<FrameCost, 3, 3, terms>(
                                         new FrameCost{model.basis(s.px), s.value, frame_scale * s.value}),
                                     nullptr, blocks[1], blocks[2]);
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorCost, terms, terms>(new PriorCost), nullptr,
                                 blocks[2]);
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = 100;
        options.function_tolerance = 1e-12;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        if (!summary.IsSolutionUsable() || !theta.allFinite())
            throw InputError(fmt::format("{}: the light in the picture cannot be fitted ({})", name, summary.message));

        // Deviations from the residuals; the frame's three channels and the chart's see one light field and one matrix.
        double chart_square = 0, frame_square = 0, srgb_square = 0;
        const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> camera(theta.data());
        for (const LitSample& s : chart) {
            const Eigen::Vector3d off =
                light_of(model.basis(s.px), theta.data() + 12) * (camera * s.reference) - s.value;
            chart_square += off.cwiseQuotient(chart_deviation(s.value, chart_white)).squaredNorm();
            srgb_square += (reflectance_with(theta, model.basis(s.px), s.value) - s.reference).squaredNorm();
        }
        for (const LitSample& s : frame)
            frame_square += (light_of(model.basis(s.px), theta.data() + 12) * theta.segment<3>(9) - s.value)
                                .cwiseQuotient(s.value)
                                .squaredNorm();
        const double chart_count = 3.0 * double(chart.size()), frame_count = 3.0 * double(frame.size());
        const double lost = 9 + 3 + terms;  // parameters, shared out by the number of values
        const double freedom = std::max(0.2, 1 - lost / (chart_count + frame_count));
        constexpr double least_scale = 2e-4;  // nothing in a photograph is better than this
        chart_scale = std::max(least_scale, std::sqrt(chart_square / (chart_count * freedom)));
        frame_scale = std::max(least_scale, std::sqrt(frame_square / (frame_count * freedom)));
        model.chart_residual_ = std::sqrt(srgb_square / chart_count);
        model.frame_residual_ = std::sqrt(frame_square / frame_count);

        if (round + 1 < rounds) continue;
        ceres::CRSMatrix J;
        ceres::Problem::EvaluateOptions all;
        all.parameter_blocks = {blocks[0], blocks[1], blocks[2]};
        problem.Evaluate(all, nullptr, nullptr, nullptr, &J);
        Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(parameters, parameters);
        for (int row = 0; row < J.num_rows; ++row)
            for (int a = J.rows[std::size_t(row)]; a < J.rows[std::size_t(row) + 1]; ++a)
                for (int b = J.rows[std::size_t(row)]; b < J.rows[std::size_t(row) + 1]; ++b)
                    normal(J.cols[std::size_t(a)], J.cols[std::size_t(b)]) +=
                        J.values[std::size_t(a)] * J.values[std::size_t(b)];
        model.covariance_ = optics::symmetric_solved(normal, Eigen::MatrixXd::Identity(parameters, parameters));
    }
    return model;
}

Eigen::Vector3d PhotoModel::reflectance_with(const Parameters& theta, const Basis& basis,
                                             const Eigen::Vector3d& value) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> M(theta.data());
    return M.inverse() * value / light_of(basis, theta.data() + 12);
}

double PhotoModel::light(const Eigen::Vector2d& px) const { return light_of(basis(px), theta_.data() + 12); }

Eigen::Vector3d PhotoModel::reflectance(const Eigen::Vector2d& px, const Eigen::Vector3d& value) const {
    return reflectance_with(theta_, basis(px), value);
}

Eigen::Vector3d PhotoModel::error(const Eigen::Vector2d& px, const Eigen::Vector3d& value) const {
    const Basis here = basis(px);
    Eigen::Matrix<double, 3, parameters> gradient;
    for (int k = 0; k < parameters; ++k) {
        const double step = 1e-5 * std::max(1e-2, std::abs(theta_[k]));
        Parameters up = theta_, down = theta_;
        up[k] += step;
        down[k] -= step;
        gradient.col(k) = (reflectance_with(up, here, value) - reflectance_with(down, here, value)) / (2 * step);
    }
    return (gradient * covariance_ * gradient.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
}

Eigen::Vector3d PhotoModel::noise(const Eigen::Vector2d& px, const Eigen::Vector3d& value_error) const {
    return (to_linear_srgb().cwiseAbs2() * value_error.cwiseAbs2()).cwiseSqrt() / light(px);
}

Eigen::Matrix3d PhotoModel::to_linear_srgb() const {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(theta_.data()).inverse();
}

Eigen::Vector3d PhotoModel::frame_reflectance() const { return to_linear_srgb() * theta_.segment<3>(9); }

}  // namespace voxtone::calibration
