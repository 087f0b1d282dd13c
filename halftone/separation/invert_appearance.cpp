// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/invert_appearance.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "optics/colour/colour.h"

namespace voxtone::halftone {

namespace {

constexpr double epsilon = 0.03;
constexpr int max_iterations = 40;

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, max_resins>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_resins, max_resins>;

/// Rows lightness, chroma, hue of the target, weighted. Near the neutral axis chroma and hue are not told apart.
Eigen::Matrix3d weights(const Eigen::Vector3d& target_oklab, const SeparationOptions& options) {
    const double chroma = std::hypot(target_oklab.y(), target_oklab.z());
    const double coloured = chroma / (chroma + 0.1);
    const double c = chroma > 0 ? target_oklab.y() / chroma : 1.0, s = chroma > 0 ? target_oklab.z() / chroma : 0.0;
    const double chroma_weight = 1 + coloured * (options.chroma_weight - 1),
                 hue_weight = 1 + coloured * (options.hue_weight - 1);
    Eigen::Matrix3d w;
    w << options.lightness_weight, 0, 0,          //
        0, chroma_weight * c, chroma_weight * s,  //
        0, -hue_weight * s, hue_weight * c;
    return w;
}

/// The weighted residual and its derivatives, and the cost, at g.
class Problem {
public:
    Problem(const AppearanceColour& colour, const Eigen::Vector3d& target_rgb, const Unknowns& penalty,
            const SeparationOptions& options)
        : colour_(colour),
          penalty_(penalty),
          target_(optics::oklab_from_linear_srgb(target_rgb)),
          w_(weights(target_, options)) {}

    struct Point {
        Unknowns g, f;
        double sum_h = 0;
        Eigen::Vector3d residual;
        double cost = 0;
    };

    [[nodiscard]] Point at(const Unknowns& g) const {
        Point p;
        p.g = g;
        p.f = g.cwiseProduct(g) + epsilon * g;
        p.sum_h = p.f.sum();
        p.f /= p.sum_h;
        const Eigen::Vector3d rgb = colour_.rgb({p.f.data(), std::size_t(p.f.size())});
        p.residual = w_ * (optics::oklab_from_linear_srgb(rgb) - target_);
        p.cost = p.residual.squaredNorm() + penalty_.dot(p.f.cwiseProduct(p.f));
        return p;
    }

    /// Gauss-Newton matrix and half gradient of the cost with respect to g.
    void linearise(const Point& p, Square& matrix, Unknowns& gradient) const {
        const Eigen::Index n = p.g.size();
        AppearanceColour::Gradient rgb_by_f;
        const Eigen::Vector3d rgb = colour_.rgb({p.f.data(), std::size_t(n)}, rgb_by_f);
        Jacobian by_f = w_ * optics::oklab_derivative(rgb) * rgb_by_f;
        // d f_s / d g_r = h'(g_r) / H (delta_rs - f_s)
        const Unknowns slope = (2 * p.g.array() + epsilon) / p.sum_h;
        const Eigen::Vector3d along = by_f * p.f;
        Jacobian by_g(3, n);
        for (Eigen::Index r = 0; r < n; ++r) by_g.col(r) = slope[r] * (by_f.col(r) - along);
        // The penalty as residuals sqrt(penalty_s) f_s.
        const Unknowns pf = penalty_.cwiseProduct(p.f);
        const double pff = penalty_.cwiseProduct(p.f).dot(p.f);
        matrix = by_g.transpose() * by_g;
        gradient = by_g.transpose() * p.residual;
        for (Eigen::Index r = 0; r < n; ++r) {
            gradient[r] += slope[r] * (pf[r] - pff);
            for (Eigen::Index q = 0; q < n; ++q)
                matrix(r, q) += slope[r] * slope[q] * ((r == q ? penalty_[r] : 0.0) - pf[r] - pf[q] + pff);
        }
    }

private:
    const AppearanceColour& colour_;
    const Unknowns& penalty_;
    Eigen::Vector3d target_;
    Eigen::Matrix3d w_;
};

/// Damped step on the variables that are free to move: those above 0, and those at 0 that want to grow.
Unknowns projected_step(const Square& matrix, const Unknowns& gradient, const Unknowns& g, double damping) {
    const Eigen::Index n = g.size();
    Square damped = matrix;
    Unknowns right = -gradient;
    for (Eigen::Index r = 0; r < n; ++r) {
        damped(r, r) += damping * (matrix(r, r) + 1e-6);
        if (g[r] <= 0 && gradient[r] > 0) {
            damped.row(r).setZero();
            damped.col(r).setZero();
            damped(r, r) = 1;
            right[r] = 0;
        }
    }
    return damped.ldlt().solve(right);
}

}  // namespace

InvertedColour invert_appearance(const AppearanceColour& colour, const Eigen::Vector3d& target_rgb,
                                 const Unknowns& penalty, const SeparationOptions& options, const Unknowns& start) {
    const Problem problem(colour, target_rgb, penalty, options);
    Problem::Point best = problem.at(start);
    double damping = 1e-3;
    InvertedColour result;
    Square matrix;
    Unknowns gradient;
    bool moved = true;
    for (; result.iterations < max_iterations && damping < 1e8; ++result.iterations) {
        if (moved) problem.linearise(best, matrix, gradient);
        Unknowns g = (best.g + projected_step(matrix, gradient, best.g, damping)).cwiseMax(0.0);
        const double largest = g.maxCoeff();
        if (!(largest > 0) || !std::isfinite(largest)) {
            moved = false;
            damping *= 8;
            continue;
        }
        const Problem::Point next = problem.at(g);
        moved = next.cost < best.cost;
        if (!moved) {
            damping *= 8;
            continue;
        }
        const double gain = best.cost - next.cost;
        best = next;
        // A small gain says little while the step is held back by damping.
        if (gain < 1e-10 + 1e-6 * best.cost && damping < 1e-2) break;
        damping = std::max(damping / 8, 1e-9);
    }
    result.g = best.g;
    result.fractions = best.f;
    result.error = best.residual.norm();
    return result;
}

}  // namespace voxtone::halftone
