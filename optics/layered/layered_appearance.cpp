// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/layered_appearance.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/contracts.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {

namespace {

// The surface reflects upward light, x+ = q + r x-, hence (1 - r)/(1 + r) U + V = 2 q/(1 + r) = (Y_surface + Y) U + p.
OrdinateVector under_surface(const AngularGrid& grid, const Admittance& top, OrdinateVector source) {
    OrdinateMatrix sum = top.Y;
    sum.diagonal().array() += (1 - grid.r) / (1 + grid.r);
    // Light that is trapped in a slab without resin that scatters or absorbs comes from nowhere and goes nowhere.
    for (Eigen::Index k = 0; k < sum.rows(); ++k)
        if (sum(k, k) == 0) sum(k, k) = 1;
    const OrdinateMatrix L = cholesky_factor(sum);
    L.triangularView<Eigen::Lower>().solveInPlace(source);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(source);
    return source;
}

}  // namespace

OrdinatePlan appearance_plan(double g, double eta, int below, int above) {
    return {angular_grid(eta, below, above), g, 2 * (below + above)};
}

OrdinatePlan directional_plan(double g, double eta, int below, int above) {
    // The solver needs positive weights. This one changes rho by 3e-7; a smaller one would lose more to rounding.
    const double view_weight = 1e-7;
    const std::array<double, 2> views{std::numbers::sqrt2 / 2, 1.0};
    return {angular_grid(eta, below, above, views, view_weight), g, 2 * (below + above)};
}

Admittance half_space(const OrdinatePlan& plan, const Medium& medium) { return LayerModes(plan, medium).half_space(); }

Admittance layered_admittance(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first,
                              const Admittance& base) {
    Admittance law = base;
    for (auto layer = layers_top_first.rbegin(); layer != layers_top_first.rend(); ++layer) {
        if (layer->medium.sigma_t() > 0) law = LayerModes(plan, layer->medium).over(law, layer->thickness_mm);
    }
    return law;
}

double appearance(const OrdinatePlan& plan, const Admittance& top) {
    const AngularGrid& grid = plan.grid();
    const Eigen::ArrayXd sqrt_c = grid.c.sqrt();
    // Radiance 1 in air is eta^2 t inside; q is 0 for trapped directions.
    const Eigen::ArrayXd q = grid.eta * grid.eta * grid.t * sqrt_c;
    const OrdinateVector U = under_surface(grid, top, (2 * q / (1 + grid.r)).matrix() - top.p);
    const Eigen::ArrayXd upward = (U.array() - q) / (1 + grid.r);
    return (sqrt_c * grid.t * upward).sum() / (sqrt_c * q).sum();
}

double reflectance_factor(const OrdinatePlan& plan, const Admittance& top, double mu_in, double mu_out) {
    const AngularGrid& grid = plan.grid();
    const int in = grid.find(mu_in), out = grid.find(mu_out);
    VOXTONE_EXPECT(in != out);
    const auto scale = [&](int k) { return grid.t[k] / (std::sqrt(grid.c[k]) * (1 + grid.r[k])); };
    const OrdinateVector U = under_surface(grid, top, OrdinateVector::Unit(grid.size(), in));
    return 2 * scale(in) * scale(out) * U[out] / (grid.eta * grid.eta);
}

double layered_appearance(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first, const Admittance& base) {
    return appearance(plan, layered_admittance(plan, layers_top_first, base));
}

double reflectance_45_0(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first, const Admittance& base) {
    return reflectance_factor(plan, layered_admittance(plan, layers_top_first, base), std::numbers::sqrt2 / 2, 1.0);
}

}  // namespace voxtone::optics
