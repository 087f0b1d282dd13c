// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/directional.h"

#include "optics/numerics/dense.h"

namespace voxtone::optics {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd reflectance_factors(const AngularGrid& grid, const MatrixXd& R) {
    const Eigen::Index n = grid.size();
    const MatrixXd bounce = MatrixXd::Identity(n, n) - scaled_columns(R, (grid.r * grid.c).matrix());
    const VectorXd t = (grid.t / grid.eta).matrix();
    return scaled_columns(scaled_rows(t, solved(bounce, R)), t);
}

double appearance_of(const AngularGrid& grid, const MatrixXd& R) {
    const MatrixXd rho = reflectance_factors(grid, R);
    return grid.eta * grid.eta * grid.c.matrix().dot(image(rho, grid.c.matrix())) / (grid.c * grid.t).sum();
}

// Radiances at the weighted directions: down and up just inside the upper surface, down and up just inside the lower
// one.
//   up_top = R_above C down_top + (e + D_up C) up_bottom         down_top = q + r up_top
//   down_bottom = (e + D_down C) down_top + R_below C up_bottom  up_bottom = q_bottom + B down_bottom
double appearance_of(const AngularGrid& grid, const LayerResponse& slab, Backing backing, double sent_back) {
    const Eigen::Index n = grid.size();
    const VectorXd c = grid.c, r = grid.r;
    const VectorXd q = (grid.eta * grid.eta * grid.t).matrix();  // radiance 1 in air
    const VectorXd q_bottom = backing == Backing::none ? q : VectorXd::Zero(n);
    MatrixXd B = r.asDiagonal();
    // A sheet returns a share of the flux that leaves, uniformly; a white one all of it.
    if (backing == Backing::white || backing == Backing::sheet) {
        B += (backing == Backing::white ? 1.0 : sent_back) * grid.t.matrix() * (grid.t * grid.c).matrix().transpose() /
             (grid.t * grid.c).sum();
    }
    MatrixXd up_to_top = scaled_columns(slab.D_up, c), down_to_bottom = scaled_columns(slab.D_down, c);
    up_to_top.diagonal() += slab.direct.matrix();
    down_to_bottom.diagonal() += slab.direct.matrix();
    const MatrixXd R_above = scaled_columns(slab.R_above, c), R_below = scaled_columns(slab.R_below, c);

    MatrixXd system = MatrixXd::Identity(2 * n, 2 * n);  // unknowns: up_top, down_bottom
    system.topLeftCorner(n, n) -= scaled_columns(R_above, r);
    system.topRightCorner(n, n) -= product(up_to_top, B);
    system.bottomLeftCorner(n, n) -= scaled_columns(down_to_bottom, r);
    system.bottomRightCorner(n, n) -= product(R_below, B);
    VectorXd source(2 * n);
    source << image(R_above, q) + image(up_to_top, q_bottom), image(down_to_bottom, q) + image(R_below, q_bottom);
    const VectorXd up_top = preimage(system, source).head(n);
    return (grid.c * grid.t * up_top.array()).sum() / (grid.c * q.array()).sum();
}

}  // namespace voxtone::optics
