// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/observer_bands.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/contracts.h"
#include "optics/numerics/dense.h"

namespace voxtone::calibration {

namespace {

// How much the sum of weights counts: a perfect diffuser is white within 1e-4.
constexpr double white_counts = 1e4;
// Reflectances below this are as dark to the eye.
constexpr double darkest = 0.01;
constexpr int most_rounds = 20;

// Normal equations of all wavelengths for X, Y and Z.
struct Normal {
    std::array<Eigen::MatrixXd, 3> matrix;
    std::array<Eigen::VectorXd, 3> right;
    std::array<double, 3> constant{};
};

Normal normal_of(const Eigen::MatrixXd& spectra, const Eigen::MatrixX3d& observer) {
    const Eigen::MatrixX3d colours = spectra * observer;
    const auto mixtures = static_cast<double>(spectra.rows());
    Normal normal;
    for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::VectorXd xyz = colours.col(static_cast<Eigen::Index>(k));
        // The square of what a step of XYZ is in roots, the cube root's slope.
        const Eigen::VectorXd weight = xyz.cwiseMax(darkest).array().pow(-4.0 / 3) / 9 / mixtures;
        const Eigen::VectorXd ones = Eigen::VectorXd::Ones(spectra.cols());
        normal.matrix[k] = spectra.transpose() * weight.asDiagonal() * spectra + white_counts * ones * ones.transpose();
        normal.right[k] = spectra.transpose() * weight.cwiseProduct(xyz) + white_counts * ones;
        normal.constant[k] = xyz.dot(weight.cwiseProduct(xyz)) + white_counts;
    }
    return normal;
}

struct Solution {
    Eigen::VectorXd x;
    double error = 0;  ///< x' M x - 2 r' x + constant
};

// Least squares with x >= 0 by active sets (Lawson and Hanson 1974, ch. 23) on normal equations.
Solution non_negative(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right, double constant) {
    const Eigen::Index n = right.size();
    std::vector<Eigen::Index> free;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    const auto unbound = [&] {
        Eigen::VectorXd of = Eigen::VectorXd::Zero(n);
        const Eigen::VectorXd solved = optics::symmetric_preimage(Eigen::MatrixXd(matrix(free, free)), right(free));
        for (std::size_t i = 0; i < free.size(); ++i) of[free[i]] = solved[static_cast<Eigen::Index>(i)];
        return of;
    };
    for (Eigen::Index step = 0; step < 3 * n && static_cast<Eigen::Index>(free.size()) < n; ++step) {
        Eigen::VectorXd gain = right - matrix * x;
        for (const Eigen::Index i : free) gain[i] = -1;
        Eigen::Index entering = 0;
        if (gain.maxCoeff(&entering) <= 1e-10 * right.norm()) break;
        free.push_back(entering);
        for (;;) {
            const Eigen::VectorXd next = unbound();
            double reach = 1;
            for (const Eigen::Index i : free)
                if (next[i] <= 0) reach = std::min(reach, x[i] / (x[i] - next[i]));
            x += reach * (next - x);
            if (reach == 1) break;
            std::erase_if(free, [&](Eigen::Index i) { return x[i] <= 1e-12; });
            if (free.empty()) break;
        }
    }
    return {x, std::max(x.dot(matrix * x) - 2 * right.dot(x) + constant, 0.0)};
}

Eigen::MatrixX3d weights_of(const Normal& normal, const std::vector<Eigen::Index>& nodes, double& error) {
    Eigen::MatrixX3d weights(nodes.size(), 3);
    error = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Solution of = non_negative(normal.matrix[k](nodes, nodes), normal.right[k](nodes), normal.constant[k]);
        weights.col(static_cast<Eigen::Index>(k)) = of.x;
        error += of.error;
    }
    return weights;
}

}  // namespace

ObserverBands observer_bands(const Eigen::MatrixXd& spectra, const Eigen::MatrixX3d& observer, Eigen::Index bands) {
    const Eigen::Index wavelengths = spectra.cols();
    VOXTONE_EXPECT(bands >= 3 && bands <= wavelengths && observer.rows() == wavelengths);
    const Normal normal = normal_of(spectra, observer);
    ObserverBands best;
    for (Eigen::Index c = 0; c < bands; ++c) best.nodes.push_back((2 * c + 1) * wavelengths / (2 * bands));
    double least = 0;
    best.weights = weights_of(normal, best.nodes, least);
    for (int round = 0; round < most_rounds; ++round) {
        bool better = false;
        for (std::size_t c = 0; c < best.nodes.size(); ++c)
            for (Eigen::Index node = 0; node < wavelengths; ++node) {
                std::vector<Eigen::Index> nodes = best.nodes;
                if (std::ranges::find(nodes, node) != nodes.end()) continue;
                nodes[c] = node;
                double error = 0;
                const Eigen::MatrixX3d weights = weights_of(normal, nodes, error);
                // A node that nothing is seen by is no band.
                if (error >= 0.999 * least || (weights.rowwise().sum().array() <= 0).any()) continue;
                best = {nodes, weights};
                least = error, better = true;
            }
        if (!better) break;
    }
    std::vector<std::size_t> order(best.nodes.size());
    for (std::size_t c = 0; c < order.size(); ++c) order[c] = c;
    std::ranges::sort(order, {}, [&](std::size_t c) { return best.nodes[c]; });
    ObserverBands sorted{{}, Eigen::MatrixX3d(bands, 3)};
    for (std::size_t c = 0; c < order.size(); ++c) {
        sorted.nodes.push_back(best.nodes[order[c]]);
        sorted.weights.row(static_cast<Eigen::Index>(c)) = best.weights.row(static_cast<Eigen::Index>(order[c]));
    }
    for (Eigen::Index k = 0; k < 3; ++k) sorted.weights.col(k) /= sorted.weights.col(k).sum();
    return sorted;
}

}  // namespace voxtone::calibration
