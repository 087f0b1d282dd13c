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

// From derivatives by the albedo and the optical depth without forward peak to those by sigma_a and sigma_s.
Medium by_medium(double by_albedo, double by_depth, double sigma_t, double albedo, double truncated,
                 double thickness_mm) {
    const double by_scattering = by_albedo * (1 - albedo) / sigma_t + by_depth * thickness_mm;
    return {-by_albedo * albedo / sigma_t + by_depth * thickness_mm, by_scattering * (1 - truncated)};
}

}  // namespace

// A change of albedo by da changes u1(0) dy u2(0) by -da times
//   u1(0) same u2(0) + u1(T) same u2(T) + u1(0) other u2(T) + u1(T) other u2(0).
OrdinateSlab::OrdinateSlab(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, bool with_derivatives)
    : with_derivatives_(with_derivatives), truncated_(plan.phase().truncated), thickness_mm_(thickness_mm) {
    VOXTONE_EXPECT(thickness_mm > 0);
    const Medium seen = visible(medium), scaled = plan.phase().scaled(seen);
    sigma_t_ = scaled.sigma_t(), albedo_ = scaled.albedo();
    const LayerModes modes(plan, seen);
    lambda_ = modes.lambda(), W_ = modes.W(), W_inverse_ = modes.W_inverse();
    const Eigen::Index n = plan.size();
    C_.resize(n), S_.resize(n);
    OrdinateVector C_lambda(n), S_lambda(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Ends e = ends(lambda_[k], sigma_t_ * thickness_mm);
        C_[k] = e.C, S_[k] = e.S, C_lambda[k] = e.C_lambda, S_lambda[k] = e.S_lambda;
    }
    if (!with_derivatives) return;
    const OrdinateMatrix E = congruence(W_inverse_, plan.even()), F = transposed_congruence(W_, plan.odd());
    same_end_.resize(n, n), other_end_.resize(n, n);
    for (Eigen::Index l = 0; l < n; ++l)
        for (Eigen::Index k = 0; k <= l; ++k) {
            const double apart = lambda_[k] - lambda_[l];
            const bool near = std::abs(apart) <= 1e-6 * (lambda_[k] + lambda_[l]);
            const double dC = near ? 0.5 * (C_lambda[k] + C_lambda[l]) : (C_[k] - C_[l]) / apart;
            const double dS = near ? 0.5 * (S_lambda[k] + S_lambda[l]) : (S_[k] - S_[l]) / apart;
            // Integrals over the depth: sinh sinh from one end dC, from both ends -dS; cosh cosh likewise.
            const double one_end = C_[l] - lambda_[l] * dC, both_ends = S_[l] - lambda_[l] * dS;
            same_end_(k, l) = same_end_(l, k) = E(k, l) * dC - F(k, l) * one_end;
            other_end_(k, l) = other_end_(l, k) = -E(k, l) * dS + F(k, l) * both_ends;
        }
}

Medium OrdinateSlab::slopes(const OrdinatePair& a, const OrdinatePair& b) const {
    const auto change = [](const OrdinateMatrix& matrix, const OrdinatePair& left, const OrdinatePair& right) {
        return left.col(0).dot(matrix * right.col(1));
    };
    const double by_albedo =
        change(same_end_, a, a) + change(same_end_, b, b) + change(other_end_, a, b) + change(other_end_, b, a);
    const OrdinatePair v = C_.asDiagonal() * a - S_.asDiagonal() * b;
    const double by_depth = v.col(0).dot(v.col(1)) - (lambda_.array() * a.col(0).array() * a.col(1).array()).sum();
    return by_medium(by_albedo, by_depth, sigma_t_, albedo_, truncated_, thickness_mm_);
}

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

OrdinateBase::OrdinateBase(std::shared_ptr<const OrdinateSlab> slab, const OrdinateBase& below)
    : slab_(std::move(slab)), with_derivatives_(slab_->with_derivatives_) {
    // u(T) = B u(0), v(0) = C u(0) - S u(T)
    OrdinateMatrix sum = congruence(slab_->W_inverse_, below.Y_);
    sum.diagonal() += slab_->C_;
    across_ = cholesky_solved(sum, slab_->S_.asDiagonal());
    OrdinateMatrix y = -scaled_rows(slab_->S_, across_);
    y.diagonal() += slab_->C_;
    Y_ = congruence(slab_->W_, y);
}

Medium OrdinateBase::slopes(OrdinatePair& light) const {
    if (slab_) {
        const OrdinatePair a = slab_->W_.transpose() * light, b = across_ * a;
        light = slab_->W_inverse_.transpose() * b;
        return slab_->slopes(a, b);
    }
    if (Y_absorption_.size() == 0) return {0, 0};
    return {-light.col(0).dot(Y_absorption_ * light.col(1)), -light.col(0).dot(Y_scattering_ * light.col(1))};
}

OrdinateLayer::OrdinateLayer(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, bool with_derivatives)
    : slab_(plan, medium, thickness_mm, with_derivatives) {
    const AngularGrid& grid = plan.grid();
    const int in = grid.find(std::numbers::sqrt2 / 2), out = grid.find(1.0);
    const auto scale = [&](int k) { return grid.t[k] / (std::sqrt(grid.c[k]) * (1 + grid.r[k])); };
    eye_ = slab_.W_inverse_.col(out);
    light_.resize(plan.size(), 2);
    light_.col(0) = 2 * scale(in) * scale(out) / (grid.eta * grid.eta) * slab_.W_inverse_.col(in);
    light_.col(1) = eye_;

    const OrdinateVector surface = ((1 - grid.r) / (1 + grid.r)).matrix();
    OrdinateMatrix A = product_transposed(scaled_columns(slab_.W_inverse_, surface), slab_.W_inverse_);
    A.diagonal() += slab_.C_;
    L_ = cholesky_factor(A);
    const OrdinateMatrix Z = lower_solved(L_, slab_.S_.asDiagonal());
    OrdinateMatrix below = -transposed_product(Z, Z);
    below.diagonal() += slab_.C_;
    P_ = congruence(slab_.W_, below);
    L_.triangularView<Eigen::Lower>().solveInPlace(light_);
    source_ = slab_.W_ * (Z.transpose() * light_);
}

LayerReflectance OrdinateLayer::upon(const OrdinateBase& base) const {
    const OrdinateMatrix sum = P_ + base.Y_;
    const OrdinateMatrix L = cholesky_factor(sum);
    OrdinatePair U = source_;
    L.triangularView<Eigen::Lower>().solveInPlace(U);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(U);
    const OrdinatePair b = slab_.W_.transpose() * U;
    // u(0) = A^-1 (W^-1 e + S b)
    OrdinatePair a = slab_.S_.asDiagonal() * b;
    L_.triangularView<Eigen::Lower>().solveInPlace(a);
    a += light_;
    L_.transpose().triangularView<Eigen::Upper>().solveInPlace(a);
    LayerReflectance result;
    result.rho = eye_.dot(a.col(0));
    if (!slab_.with_derivatives_ || !base.with_derivatives_) return result;
    result.by_layer = slab_.slopes(a, b);
    result.by_base = base.slopes(U);
    result.under = U;
    return result;
}

}  // namespace voxtone::optics
