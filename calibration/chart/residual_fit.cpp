// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/residual_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "base/parallel.h"

namespace voxtone::calibration {

namespace {

using optics::ColourResidual;

Eigen::MatrixXd kernel_matrix(const ChartData& data, const ResidualShape& shape) {
    const Eigen::Index n = data.mixtures();
    Eigen::MatrixXd x(n, data.resins());
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::VectorXd shares = data.shares.row(i).transpose();
        x.row(i) = ColourResidual::place({shares.data(), static_cast<std::size_t>(shares.size())}, shape.lengths);
    }
    const Eigen::VectorXd squares = x.rowwise().squaredNorm();
    Eigen::MatrixXd kernel = -2 * (x * x.transpose());
    kernel.colwise() += squares;
    kernel.rowwise() += squares.transpose();
    // Column by column in one thread: callers try several shapes at once.
    kernel = kernel.unaryExpr([](double square) { return ColourResidual::kernel(std::sqrt(std::max(square, 0.0))); });
    kernel.diagonal().array() = 1 + shape.noise / data.repeats.array();
    return kernel;
}

// (L L^T)^-1_ii is the squared length of column i of L^-1, which is 0 above its diagonal: columns by blocks, of each
// the rows from there on.
Eigen::VectorXd inverse_diagonal(const Eigen::LLT<Eigen::MatrixXd>& factor) {
    constexpr Eigen::Index wide = 96;
    const Eigen::MatrixXd& L = factor.matrixLLT();
    const Eigen::Index n = L.rows();
    Eigen::VectorXd diagonal(n);
    for (Eigen::Index at = 0; at < n; at += wide) {
        const Eigen::Index rows = n - at, columns = std::min(wide, rows);
        Eigen::MatrixXd block = Eigen::MatrixXd::Identity(rows, columns);
        L.bottomRightCorner(rows, rows).triangularView<Eigen::Lower>().solveInPlace(block);
        diagonal.segment(at, columns) = block.colwise().squaredNorm().transpose();
    }
    return diagonal;
}

// Mean CIEDE2000, by the metric, of what each mixture would be off if it were left out.
double left_out_error(const ChartData& data, const Eigen::MatrixX3d& left, const ResidualShape& shape) {
    const Eigen::LLT<Eigen::MatrixXd> factor(kernel_matrix(data, shape));
    const Eigen::MatrixX3d weights = factor.solve(left);
    const Eigen::Index n = data.mixtures();
    const Eigen::VectorXd diagonal = inverse_diagonal(factor);
    double sum = 0;
    for (Eigen::Index i = 0; i < n; ++i)
        sum += (data.metric[static_cast<std::size_t>(i)] * weights.row(i).transpose() / diagonal[i]).norm();
    return sum / static_cast<double>(n);
}

std::vector<double> left_out_errors(const ChartData& data, const Eigen::MatrixX3d& left,
                                    const std::vector<ResidualShape>& shapes, const Progress* progress) {
    std::vector<double> errors(shapes.size());
    parallel_for(
        0, shapes.size(), 1, [&](std::size_t k) { errors[k] = left_out_error(data, left, shapes[k]); }, progress);
    return errors;
}

}  // namespace

ResidualShape usual_residual_shape(Eigen::Index resins) {
    return {std::vector<double>(static_cast<std::size_t>(resins), 1.2), 0.02};
}

std::vector<optics::ColourResidual> make_residuals(const ChartData& data, const std::vector<Eigen::MatrixX3d>& left,
                                                   const ResidualShape& shape) {
    const Eigen::LLT<Eigen::MatrixXd> factor(kernel_matrix(data, shape));
    std::vector<optics::ColourResidual> residuals;
    for (const Eigen::MatrixX3d& of : left) residuals.emplace_back(shape.lengths, data.shares, factor.solve(of));
    return residuals;
}

optics::ColourResidual make_residual(const ChartData& data, const Eigen::MatrixX3d& left, const ResidualShape& shape) {
    return make_residuals(data, {left}, shape).front();
}

ChosenResidual choose_residual_shape(const ChartData& data, const Eigen::MatrixX3d& left, const Progress* progress) {
    const auto resins = static_cast<std::size_t>(data.resins());
    // Which noise goes with a length every second of many mixtures tells as well, in an eighth of the time.
    constexpr Eigen::Index many = 500;
    const Eigen::Index step = data.mixtures() > many ? 2 : 1;
    std::vector<Eigen::Index> some;
    for (Eigen::Index i = 0; i < data.mixtures(); i += step) some.push_back(i);
    const std::vector<double> noises{0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0};
    std::vector<ResidualShape> shapes;
    for (const double length : {0.7, 1.2, 2.0})
        for (const double noise : noises) shapes.push_back({std::vector<double>(resins, length), noise});
    std::vector<double> errors = left_out_errors(chart_rows(data, some), left(some, Eigen::all), shapes, progress);
    std::vector<ResidualShape> of_lengths;
    for (auto of = errors.begin(); of != errors.end(); of += std::ssize(noises))
        of_lengths.push_back(shapes[std::size_t(std::min_element(of, of + std::ssize(noises)) - errors.begin())]);
    errors = left_out_errors(data, left, of_lengths, progress);
    auto best = static_cast<std::size_t>(std::min_element(errors.begin(), errors.end()) - errors.begin());
    ChosenResidual chosen{of_lengths[best], errors[best], false};
    // One length after the other; few mixtures cannot tell them apart.
    const bool enough = data.mixtures() >= 100;
    double factor = 1.6;
    for (int round = 0; enough && round < 3; ++round, factor = std::sqrt(factor))
        for (std::size_t r = 0; r <= resins; ++r) {
            shapes.assign(2, chosen.shape);
            for (std::size_t k = 0; k < 2; ++k) {
                double& value = r < resins ? shapes[k].lengths[r] : shapes[k].noise;
                value *= k == 0 ? factor : 1 / factor;
            }
            errors = left_out_errors(data, left, shapes, progress);
            best = errors[0] < errors[1] ? 0 : 1;
            if (errors[best] < chosen.left_out) chosen.shape = shapes[best], chosen.left_out = errors[best];
        }
    double without = 0;
    for (Eigen::Index i = 0; i < data.mixtures(); ++i)
        without += (data.metric[static_cast<std::size_t>(i)] * left.row(i).transpose()).norm();
    chosen.helps = chosen.left_out < without / static_cast<double>(data.mixtures());
    return chosen;
}

}  // namespace voxtone::calibration
