// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/directional.h"

#include <Eigen/LU>

namespace voxtone::optics {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd reflectance_factors(const AngularGrid& grid, const MatrixXd& R) {
    const Eigen::Index n = grid.size();
    const MatrixXd bounce = MatrixXd::Identity(n, n) - R * (grid.r * grid.c).matrix().asDiagonal();
    const VectorXd t = (grid.t / grid.eta).matrix();
    return t.asDiagonal() * bounce.partialPivLu().solve(R) * t.asDiagonal();
}

double appearance_of(const AngularGrid& grid, const MatrixXd& R) {
    const MatrixXd rho = reflectance_factors(grid, R);
    return grid.eta * grid.eta * grid.c.matrix().dot(rho * grid.c.matrix()) / (grid.c * grid.t).sum();
}

// Radiances at the weighted directions: down and up just inside the upper surface, down and up just inside the lower
// one.
//   up_top = R_above C down_top + (e + D_up C) up_bottom         down_top = q + r up_top
//   down_bottom = (e + D_down C) down_top + R_below C up_bottom  up_bottom = q_bottom + B down_bottom
double appearance_of(const AngularGrid& grid, const LayerResponse& slab, Backing backing, double sent_back) {
    const Eigen::Index n = grid.size();
    const auto C = grid.c.matrix().asDiagonal();
    const auto r = grid.r.matrix().asDiagonal();
    const VectorXd q = (grid.eta * grid.eta * grid.t).matrix();  // radiance 1 in air
    const VectorXd q_bottom = backing == Backing::none ? q : VectorXd::Zero(n);
    MatrixXd B = r;
    // A sheet returns a share of the flux that leaves, uniformly; a white one all of it.
    if (backing == Backing::white || backing == Backing::sheet) {
        B += (backing == Backing::white ? 1.0 : sent_back) * grid.t.matrix() * (grid.t * grid.c).matrix().transpose() /
             (grid.t * grid.c).sum();
    }
    MatrixXd up_to_top = slab.D_up * C, down_to_bottom = slab.D_down * C;
    up_to_top.diagonal() += slab.direct.matrix();
    down_to_bottom.diagonal() += slab.direct.matrix();
    const MatrixXd R_above = slab.R_above * C, R_below = slab.R_below * C;

    MatrixXd system = MatrixXd::Identity(2 * n, 2 * n);  // unknowns: up_top, down_bottom
    system.topLeftCorner(n, n) -= R_above * r;
    system.topRightCorner(n, n) -= up_to_top * B;
    system.bottomLeftCorner(n, n) -= down_to_bottom * r;
    system.bottomRightCorner(n, n) -= R_below * B;
    VectorXd source(2 * n);
    source << R_above * q + up_to_top * q_bottom, down_to_bottom * q + R_below * q_bottom;
    const VectorXd up_top = system.partialPivLu().solve(source).head(n);
    return (grid.c * grid.t * up_top.array()).sum() / (grid.c * q.array()).sum();
}

}  // namespace voxtone::optics
