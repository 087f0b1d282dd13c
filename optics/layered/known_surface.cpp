// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/known_surface.h"

#include <algorithm>
#include <numbers>

#include "optics/layered/layer_modes.h"
#include "optics/numerics/dense.h"
#include "optics/scene/sheet.h"

namespace voxtone::optics {

namespace {

/// What the face throws back of diffuse light from within.
double diffuse_within(const AngularGrid& grid) { return (grid.c * grid.r).sum() / grid.c.sum(); }

/// Of directions that know nothing of each other: V = (1 - R) / (1 + R) U.
Admittance by_direction(const Eigen::ArrayXd& reflected) {
    const OrdinateVector y = ((1 - reflected) / (1 + reflected)).matrix();
    return {y.asDiagonal().toDenseMatrix(), OrdinateVector::Zero(y.size())};
}

/// A share of the flux comes back uniformly: R = share v v^T / (v.v), v = sqrt(c).
Admittance diffuser_in_contact(const AngularGrid& grid, double share) {
    const Eigen::Index n = grid.c.size();
    const OrdinateVector v = grid.c.sqrt().matrix();
    OrdinateMatrix one_plus_R = share * (v * v.transpose());
    one_plus_R /= grid.c.sum();
    one_plus_R.diagonal().array() += 1;
    OrdinateMatrix Y = 2 * cholesky_solved(one_plus_R, OrdinateMatrix::Identity(n, n));
    Y.diagonal().array() -= 1;
    return {Y, OrdinateVector::Zero(n)};
}

/// What a smooth surface reflects of diffuse light in air, its face included.
double diffuse_in_air(const AngularGrid& grid, double albedo) {
    const double face = reflectance_in_air(grid.eta), within = diffuse_within(grid);
    return face + (1 - face) * (1 - within) * albedo / (1 - within * albedo);
}

}  // namespace

double albedo_under_face(const OrdinatePlan& plan, double rho) {
    const AngularGrid& grid = plan.grid();
    const double through = grid.t[grid.find(std::numbers::sqrt2 / 2)] * grid.t[grid.find(1)] / (grid.eta * grid.eta);
    const double least = std::max(rho, 0.0);
    return std::min(least / (through + diffuse_within(grid) * least), 1.0);
}

Admittance admittance_of(const OrdinatePlan& plan, const KnownSurface& surface, double bare) {
    const AngularGrid& grid = plan.grid();
    const double rho = std::clamp(bare, 0.0, 1.0);
    if (surface.finish == BareFinish::mirror)
        return by_direction(surface.gap ? (grid.r + grid.t.square() * rho / (1 - grid.r * rho)).eval()
                                        : Eigen::ArrayXd::Constant(grid.c.size(), rho).eval());
    const bool smooth = surface.finish == BareFinish::smooth;
    if (!surface.gap) return diffuser_in_contact(grid, smooth ? albedo_under_face(plan, rho) : rho);
    const double in_air = smooth ? diffuse_in_air(grid, albedo_under_face(plan, rho)) : rho;
    return Admittance::white_sheet(plan, share_sent_back(in_air, reflectance_in_air(grid.eta)));
}

}  // namespace voxtone::optics
