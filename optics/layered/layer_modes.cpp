// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/layer_modes.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {

namespace {

// Optical depths below this leave no trace in double precision next to the layers around them.
constexpr double negligible_depth = 1e-9;

}  // namespace

OrdinatePlan::OrdinatePlan(const AngularGrid& grid, double g, int terms)
    : grid_(grid), phase_(conserving_henyey_greenstein(grid, g, terms)) {
    VOXTONE_EXPECT(grid.size() >= 1 && grid.size() <= max_ordinates);
    VOXTONE_EXPECT((grid.c > 0).all());
    inverse_nu_ = (1 / grid.nu).matrix();
    sqrt_c_ = grid.c.sqrt().matrix();
    const OrdinateVector s = sqrt_c_.cwiseProduct(inverse_nu_);
    even_ = 0.25 * (s.asDiagonal() * (phase_.same + phase_.opposite) * s.asDiagonal());
    odd_ = 0.25 * (s.asDiagonal() * (phase_.same - phase_.opposite) * s.asDiagonal());
}

Admittance Admittance::black(const OrdinatePlan& plan) {
    const int n = plan.size();
    return {OrdinateMatrix::Identity(n, n), OrdinateVector::Zero(n)};
}

// Upward light x- = r x+ + q with q = eta^2 t sqrt(c) for radiance 1 in the air below.
Admittance Admittance::air(const OrdinatePlan& plan, bool lit) {
    const AngularGrid& grid = plan.grid();
    const OrdinateVector y = ((1 - grid.r) / (1 + grid.r)).matrix();
    const double radiance = lit ? 1 : 0;
    const OrdinateVector q = (radiance * grid.eta * grid.eta * grid.t).matrix().cwiseProduct(plan.sqrt_c_);
    return {y.asDiagonal().toDenseMatrix(), (-2 * q.array() / (1 + grid.r)).matrix()};
}

// The sheet returns a share of the flux v.x+ that leaves, uniformly: R = diag(r) + share v v^T / (1.v), v = t sqrt(c).
Admittance Admittance::white_sheet(const OrdinatePlan& plan, double share) {
    const AngularGrid& grid = plan.grid();
    const int n = plan.size();
    const OrdinateVector v = grid.t.matrix().cwiseProduct(plan.sqrt_c_);
    OrdinateMatrix one_plus_R = share * (v * v.transpose());
    one_plus_R /= (grid.t * grid.c).sum();
    one_plus_R.diagonal().array() += 1 + grid.r;
    OrdinateMatrix Y = 2 * cholesky_solved(one_plus_R, OrdinateMatrix::Identity(n, n));
    Y.diagonal().array() -= 1;
    return {Y, OrdinateVector::Zero(n)};
}

LayerModes::LayerModes(const OrdinatePlan& plan, const Medium& medium) {
    const Medium scaled = plan.phase_.scaled(medium);
    // Clear as air: so little that a metre of it takes a thousandth.
    constexpr double least_sigma_t = 1e-6;
    VOXTONE_EXPECT(scaled.sigma_t() >= 0);
    const bool is_clear = scaled.sigma_t() < least_sigma_t;
    sigma_t_ = is_clear ? least_sigma_t : scaled.sigma_t();
    const double albedo = is_clear ? 0 : scaled.albedo();
    OrdinateMatrix E = -albedo * plan.even_, F = -albedo * plan.odd_;
    E.diagonal() += plan.inverse_nu_;
    F.diagonal() += plan.inverse_nu_;
    // F = L L^T;  L^T E L = Q Lambda Q^T;  W = L^-T Q.
    const OrdinateMatrix L = cholesky_factor(F);
    const OrdinateMatrix K = transposed_product(L, product(E, L));
    const SymmetricEigen eigen = symmetric_eigen(K);
    lambda_ = eigen.values.cwiseMax(0);
    W_ = lower_transposed_solved(L, eigen.vectors);
    W_inverse_ = transposed_product(eigen.vectors, L.transpose());
    // The diffusion mode's small eigenvalue drowns in the rounding of the largest (up to 1/nu^2 = 1e6); its Rayleigh
    // quotient does not. Where nothing absorbs it is 0.
    const OrdinateVector slowest = W_inverse_.row(0).transpose();
    lambda_[0] = scaled.sigma_a == 0 ? 0 : std::max(0.0, slowest.dot(image(E, slowest)));
}

Admittance LayerModes::half_space() const {
    return {product_transposed(scaled_columns(W_, lambda_.cwiseSqrt()), W_), OrdinateVector::Zero(lambda_.size())};
}

Admittance LayerModes::over(const Admittance& below, double thickness_mm) const {
    VOXTONE_EXPECT(thickness_mm >= 0);
    const double depth = sigma_t_ * thickness_mm;
    if (depth < negligible_depth) return below;
    const Eigen::Index n = lambda_.size();
    OrdinateVector C(n), s(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const double root = std::sqrt(lambda_[k]), x = root * depth;
        // x coth x and x / sinh x; their series where the quotients lose digits, their limits where exp overflows.
        const double sinh_x = x < 700 ? std::sinh(x) : INFINITY;
        C[k] = x < 1e-4 ? (1 + x * x / 3) / depth : root / std::tanh(x);
        s[k] = x < 1e-4 ? (1 - x * x / 6) / depth : root / sinh_x;
    }
    OrdinateMatrix sum = congruence(W_inverse_, below.Y);
    sum.diagonal() += C;
    // s (C + y)^-1 s = Z^T Z with Z = L^-1 s
    const OrdinateMatrix L = cholesky_factor(sum), Z = lower_solved(L, s.asDiagonal());
    OrdinateMatrix y = -transposed_product(Z, Z);
    y.diagonal() += C;
    OrdinateVector p = image(W_inverse_, below.p);
    L.triangularView<Eigen::Lower>().solveInPlace(p);
    return {congruence(W_, y), image(W_, Z.transpose() * p)};
}

OrdinateVector LayerModes::decay_per_mm() const { return sigma_t_ * lambda_.cwiseSqrt(); }

}  // namespace voxtone::optics
