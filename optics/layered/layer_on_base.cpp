// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/layer_on_base.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/contracts.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {

namespace {

constexpr double least_extinction = 1e-7;

Medium visible(const Medium& medium) {
    return medium.sigma_t() >= least_extinction ? medium : Medium{0, least_extinction};
}

// C = x coth x / T and S = x / (sinh x T) with x = sqrt(lambda) T, and their derivatives by lambda.
struct Ends {
    double C, S, C_lambda, S_lambda;
};

Ends ends(double lambda, double T) {
    const double root = std::sqrt(lambda), x = root * T;
    if (x < 0.05) {
        const double y = x * x;
        return {(1 + y / 3 - y * y / 45 + 2 * y * y * y / 945) / T,
                (1 - y / 6 + 7 * y * y / 360 - 31 * y * y * y / 15120) / T,
                T * (1.0 / 3 - 2 * y / 45 + 2 * y * y / 315), -T * (1.0 / 6 - 7 * y / 180 + 31 * y * y / 5040)};
    }
    if (x > 350) return {root, 0, 0.5 / root, 0};
    const double inverse_sinh = 1 / std::sinh(x), coth = std::sqrt(1 + inverse_sinh * inverse_sinh);
    return {root * coth, root * inverse_sinh, 0.5 * (coth / root - T * inverse_sinh * inverse_sinh),
            0.5 * inverse_sinh * (1 / root - T * coth)};
}

// A change of albedo by da changes u1(0) dy u2(0) by -da times
//   u1(0) same u2(0) + u1(T) same u2(T) + u1(0) other u2(T) + u1(T) other u2(0).
struct Change {
    OrdinateVector C, S;
    OrdinateMatrix same, other;
};

Change albedo_change(const OrdinatePlan& plan, const LayerModes& modes, double T, bool with_derivatives) {
    const Eigen::Index n = plan.size();
    Change change{OrdinateVector(n), OrdinateVector(n), {}, {}};
    OrdinateVector C_lambda(n), S_lambda(n);
    const OrdinateVector& lambda = modes.lambda();
    for (Eigen::Index k = 0; k < n; ++k) {
        const Ends e = ends(lambda[k], T);
        change.C[k] = e.C, change.S[k] = e.S, C_lambda[k] = e.C_lambda, S_lambda[k] = e.S_lambda;
    }
    if (!with_derivatives) return change;
    const OrdinateMatrix E = congruence(modes.W_inverse(), plan.even());
    const OrdinateMatrix F = transposed_congruence(modes.W(), plan.odd());
    change.same.resize(n, n), change.other.resize(n, n);
    for (Eigen::Index l = 0; l < n; ++l)
        for (Eigen::Index k = 0; k <= l; ++k) {
            const double apart = lambda[k] - lambda[l];
            const bool near = std::abs(apart) <= 1e-6 * (lambda[k] + lambda[l]);
            const double dC = near ? 0.5 * (C_lambda[k] + C_lambda[l]) : (change.C[k] - change.C[l]) / apart;
            const double dS = near ? 0.5 * (S_lambda[k] + S_lambda[l]) : (change.S[k] - change.S[l]) / apart;
            // Integrals over the depth: sinh sinh from one end dC, from both ends -dS; cosh cosh likewise.
            const double one_end = change.C[l] - lambda[l] * dC, both_ends = change.S[l] - lambda[l] * dS;
            change.same(k, l) = change.same(l, k) = E(k, l) * dC - F(k, l) * one_end;
            change.other(k, l) = change.other(l, k) = -E(k, l) * dS + F(k, l) * both_ends;
        }
    return change;
}

// From derivatives by the albedo and the optical depth without forward peak to those by sigma_a and sigma_s.
Medium by_medium(double by_albedo, double by_depth, double sigma_t, double albedo, double truncated,
                 double thickness_mm) {
    const double by_scattering = by_albedo * (1 - albedo) / sigma_t + by_depth * thickness_mm;
    return {-by_albedo * albedo / sigma_t + by_depth * thickness_mm, by_scattering * (1 - truncated)};
}

}  // namespace

OrdinateBase::OrdinateBase(const OrdinatePlan& plan, const Medium& medium, bool with_derivatives)
    : with_derivatives_(with_derivatives) {
    const Medium seen = visible(medium), scaled = plan.phase().scaled(seen);
    const LayerModes modes(plan, seen);
    const OrdinateVector s = modes.lambda().cwiseSqrt();
    const OrdinateMatrix& W = modes.W();
    Y_ = product_transposed(scaled_columns(W, s), W);
    if (!with_derivatives) return;
    OrdinateMatrix change = congruence(modes.W_inverse(), plan.even());
    const OrdinateMatrix F = transposed_congruence(W, plan.odd());
    for (Eigen::Index l = 0; l < s.size(); ++l)
        for (Eigen::Index k = 0; k < s.size(); ++k)
            change(k, l) = (change(k, l) - s[k] * s[l] * F(k, l)) / std::max(s[k] + s[l], 1e-12);
    const OrdinateMatrix by_albedo = -congruence(W, change);
    const Medium chain = by_medium(1, 0, scaled.sigma_t(), scaled.albedo(), plan.phase().truncated, 0);
    Y_absorption_ = chain.sigma_a * by_albedo;
    Y_scattering_ = chain.sigma_s * by_albedo;
}

OrdinateBase::OrdinateBase(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, const Admittance& below,
                           bool with_derivatives)
    : with_derivatives_(with_derivatives) {
    VOXTONE_EXPECT(thickness_mm > 0);
    const Medium seen = visible(medium), scaled = plan.phase().scaled(seen);
    const LayerModes modes(plan, seen);
    const OrdinateMatrix& W = modes.W();
    const Change change = albedo_change(plan, modes, modes.depth_per_mm() * thickness_mm, with_derivatives);
    // u(T) = B u(0), v(0) = C u(0) - S u(T)
    OrdinateMatrix sum = congruence(modes.W_inverse(), below.Y);
    sum.diagonal() += change.C;
    const OrdinateMatrix B = cholesky_solved(sum, change.S.asDiagonal());
    OrdinateMatrix y = -scaled_rows(change.S, B);
    y.diagonal() += change.C;
    Y_ = congruence(W, y);
    if (!with_derivatives) return;
    const OrdinateMatrix across = product(change.other, B);
    const OrdinateMatrix y_albedo =
        -(change.same + transposed_congruence(B, change.same) + across + across.transpose());
    OrdinateMatrix y_depth = -product(y, y);
    y_depth.diagonal() += modes.lambda();
    const OrdinateMatrix by_albedo = congruence(W, y_albedo), by_depth = congruence(W, y_depth);
    const auto chain = [&](double a, double d) {
        return by_medium(a, d, scaled.sigma_t(), scaled.albedo(), plan.phase().truncated, thickness_mm);
    };
    Y_absorption_ = chain(1, 0).sigma_a * by_albedo + chain(0, 1).sigma_a * by_depth;
    Y_scattering_ = chain(1, 0).sigma_s * by_albedo + chain(0, 1).sigma_s * by_depth;
}

OrdinateLayer::OrdinateLayer(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, bool with_derivatives)
    : plan_(&plan), with_derivatives_(with_derivatives), truncated_(plan.phase().truncated), depth_(thickness_mm) {
    VOXTONE_EXPECT(thickness_mm > 0);
    const Medium seen = visible(medium), scaled = plan.phase().scaled(seen);
    sigma_t_ = scaled.sigma_t();
    albedo_ = scaled.albedo();
    const LayerModes modes(plan, seen);
    const AngularGrid& grid = plan.grid();
    const Eigen::Index n = plan.size();
    Change change = albedo_change(plan, modes, sigma_t_ * thickness_mm, with_derivatives);
    lambda_ = modes.lambda();
    W_ = modes.W();
    C_ = std::move(change.C), S_ = std::move(change.S);
    same_end_ = std::move(change.same), other_end_ = std::move(change.other);

    const int in = grid.find(std::numbers::sqrt2 / 2), out = grid.find(1.0);
    const auto scale = [&](int k) { return grid.t[k] / (std::sqrt(grid.c[k]) * (1 + grid.r[k])); };
    scale_ = 2 * scale(in) * scale(out) / (grid.eta * grid.eta);
    W_inverse_e_.resize(n, 2);
    W_inverse_e_.col(0) = modes.W_inverse().col(in);
    W_inverse_e_.col(1) = modes.W_inverse().col(out);

    const OrdinateVector surface = ((1 - grid.r) / (1 + grid.r)).matrix();
    OrdinateMatrix A = product_transposed(scaled_columns(modes.W_inverse(), surface), modes.W_inverse());
    A.diagonal() += C_;
    L_ = cholesky_factor(A);
    const OrdinateMatrix Z = lower_solved(L_, S_.asDiagonal());
    OrdinateMatrix below = -transposed_product(Z, Z);
    below.diagonal() += C_;
    P_ = congruence(W_, below);
    light_ = W_inverse_e_;
    L_.triangularView<Eigen::Lower>().solveInPlace(light_);
    source_ = W_ * (Z.transpose() * light_);
}

LayerReflectance OrdinateLayer::upon(const OrdinateBase& base) const {
    using Pair = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, max_ordinates, 2>;
    const OrdinateMatrix sum = P_ + base.Y_;
    const OrdinateMatrix L = cholesky_factor(sum);
    Pair U = source_;
    L.triangularView<Eigen::Lower>().solveInPlace(U);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(U);
    const Pair b = W_.transpose() * U;
    // u(0) = A^-1 (W^-1 e + S b)
    Pair a = S_.asDiagonal() * b;
    L_.triangularView<Eigen::Lower>().solveInPlace(a);
    a += light_;
    L_.transpose().triangularView<Eigen::Upper>().solveInPlace(a);
    LayerReflectance result;
    result.rho = scale_ * W_inverse_e_.col(1).dot(a.col(0));
    if (!with_derivatives_ || !base.with_derivatives_) return result;
    const auto change = [&](const OrdinateMatrix& matrix, const Pair& left, const Pair& right) {
        return left.col(0).dot(matrix * right.col(1));
    };
    const double by_albedo = scale_ * (change(same_end_, a, a) + change(same_end_, b, b) + change(other_end_, a, b) +
                                       change(other_end_, b, a));
    const Pair v = C_.asDiagonal() * a - S_.asDiagonal() * b;
    const double by_depth =
        -scale_ * ((lambda_.array() * a.col(0).array() * a.col(1).array()).sum() - v.col(0).dot(v.col(1)));
    result.by_layer = by_medium(by_albedo, by_depth, sigma_t_, albedo_, truncated_, depth_);
    result.by_base = {-scale_ * change(base.Y_absorption_, U, U), -scale_ * change(base.Y_scattering_, U, U)};
    return result;
}

}  // namespace voxtone::optics
