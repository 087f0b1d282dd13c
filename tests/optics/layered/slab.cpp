// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optics/layered/slab.h"

#include <cmath>

#include <Eigen/LU>

#include "optics/layered/directional.h"
#include "optics/numerics/quadrature.h"
#include "optics/scene/fresnel.h"

namespace voxtone::optics::testing {

using Eigen::ArrayXd;
using Eigen::MatrixXd;

namespace {

// The direct beam between two surfaces: flux reflected and transmitted in all, for incidence along mu in air.
struct Beam {
    double reflected, transmitted;
};

Beam direct_beam(double mu, double eta, double tau) {
    const double r = fresnel_reflectance(mu, eta), t = 1 - r, e = std::exp(-tau / cosine_in_resin(mu, eta));
    const double echo = t * t * e / (1 - r * r * e * e);
    return {r + r * e * echo, echo};
}

// Adds what was scattered, per incident direction, to what was not.
FluxTotals with_scattered(FluxTotals totals, const AngularGrid& grid, const ArrayXd& reflected,
                          const ArrayXd& transmitted) {
    const int normal = grid.find(1.0);
    const ArrayXd lambertian = grid.eta * grid.eta * grid.c * (grid.mu > 0).cast<double>();
    totals.UR1 += reflected[normal];
    totals.UT1 += transmitted[normal];
    totals.URU += (lambertian * reflected).sum();
    totals.UTU += (lambertian * transmitted).sum();
    return totals;
}

}  // namespace

ArrayXd hemispherical_reflectance(const AngularGrid& grid, const MatrixXd& rho) {
    return grid.eta * grid.eta * (rho.transpose() * grid.c.matrix()).array();
}

FluxTotals unscattered(double eta, double tau) {
    const Beam normal = direct_beam(1, eta, tau);
    FluxTotals totals{normal.reflected, normal.transmitted, 0, 0};
    // Lambertian incidence: integral of 2 mu dmu. mu = s^2 tames the square roots of Fresnel's formulas at grazing
    // angles.
    static const Rule rule = gauss_legendre(200, 0, 1);
    for (std::size_t k = 0; k < rule.x.size(); ++k) {
        const double mu = rule.x[k] * rule.x[k], weight = 4 * mu * rule.x[k] * rule.w[k];
        const Beam beam = direct_beam(mu, eta, tau);
        totals.URU += weight * beam.reflected;
        totals.UTU += weight * beam.transmitted;
    }
    return totals;
}

FluxTotals slab_totals(const AngularGrid& grid, const LayerResponse& slab) {
    const Eigen::Index n = grid.size();
    const ArrayXd& e = slab.direct;
    const auto C = grid.c.matrix().asDiagonal();
    const auto r = grid.r.matrix().asDiagonal();
    // Direct beams per unit flux in air: down at the top, up at the bottom (after all their mirror reflections).
    const ArrayXd down = (grid.t > 0).select(grid.t / (1 - grid.r * grid.r * e * e), 0.0), up = grid.r * e * down;
    MatrixXd source(2 * n, n);
    source << slab.R_above * down.matrix().asDiagonal().toDenseMatrix() +
                  slab.D_up * up.matrix().asDiagonal().toDenseMatrix(),
        slab.D_down * down.matrix().asDiagonal().toDenseMatrix() +
            slab.R_below * up.matrix().asDiagonal().toDenseMatrix();
    // Scattered light up at the top and down at the bottom, reflected between the surfaces.
    MatrixXd up_to_top = slab.D_up * C, down_to_bottom = slab.D_down * C;
    up_to_top.diagonal() += e.matrix();
    down_to_bottom.diagonal() += e.matrix();
    MatrixXd system = MatrixXd::Identity(2 * n, 2 * n);
    system.topLeftCorner(n, n) -= slab.R_above * C * r;
    system.topRightCorner(n, n) -= up_to_top * r;
    system.bottomLeftCorner(n, n) -= down_to_bottom * r;
    system.bottomRightCorner(n, n) -= slab.R_below * C * r;
    const MatrixXd light = system.partialPivLu().solve(source);
    const Eigen::RowVectorXd leaving = (grid.c * grid.t).matrix().transpose();
    // The depth that the direct beams saw, from the normal direction: without the forward peak of the phase function.
    const double depth = -std::log(e[grid.find(1.0)]);
    return with_scattered(unscattered(grid.eta, depth), grid, (leaving * light.topRows(n)).array(),
                          (leaving * light.bottomRows(n)).array());
}

FluxTotals half_space_totals(const AngularGrid& grid, const MatrixXd& R) {
    return with_scattered(unscattered(grid.eta, INFINITY), grid,
                          hemispherical_reflectance(grid, reflectance_factors(grid, R)), ArrayXd::Zero(grid.size()));
}

}  // namespace voxtone::optics::testing
