// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/adding_doubling.h"

#include <cmath>

#include "base/contracts.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {

namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double first_depth = 1e-8;
// A conservative half-space differs from a slab of depth tau by 1/tau: 2^80 * 1e-8 = 1e16 is enough.
constexpr int most_doublings = 80;

// What reaches the interface between an upper layer and what is below it, for light from above: scattered light down
// and up.
struct Interface {
    MatrixXd down, up;
};

Interface between(const LayerResponse& upper, const MatrixXd& R_lower, const ArrayXd& c) {
    const VectorXd C = c, e = upper.direct;
    const Eigen::Index n = c.size();
    // Light that goes back and forth: S = Q + Q C Q + ... with Q = R*_upper C R_lower.
    const MatrixXd Q = product(upper.R_below, scaled_rows(C, R_lower));
    const MatrixXd S = solved(MatrixXd(MatrixXd::Identity(n, n) - scaled_columns(Q, C)), Q);
    Interface light;
    light.down = upper.D_down + scaled_columns(S, e) + product(S, scaled_rows(C, upper.D_down));
    light.up = scaled_columns(R_lower, e) + product(R_lower, scaled_rows(C, light.down));
    return light;
}

}  // namespace

struct AddingDoubling::Symmetric {
    MatrixXd R, D;
    double depth;
    ArrayXd direct;
};

AddingDoubling::AddingDoubling(const AngularGrid& grid, double g, int terms)
    : grid_(grid), phase_(conserving_henyey_greenstein(grid, g, terms)) {}

// Light that is scattered exactly once:
//   R = a/4 h_opposite (1 - exp(-d (1/nu_i + 1/nu_j))) / (nu_i + nu_j)
//   D = a/4 h_same exp(-d/nu_i) d/(nu_i nu_j) (1 - exp(-x))/x,   x = d (1/nu_j - 1/nu_i)
// and twice, to leading order: with A, B = a/4 h/(nu_i nu_j), R += d^2/2 (A C B + B C A), D += d^2/2 (A C A + B C B).
// Without the second term a layer would lose energy of order d at every scattering, with it of order d^2.
AddingDoubling::Symmetric AddingDoubling::thin(double albedo, double depth) const {
    const Eigen::Index n = grid_.size();
    Symmetric layer{MatrixXd(n, n), MatrixXd(n, n), depth, (-depth / grid_.nu).exp()};
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < n; ++i) {
            const double nu_i = grid_.nu[i], nu_j = grid_.nu[j];
            const double x = depth * (1 / nu_j - 1 / nu_i);
            const double mean_path = x == 0 ? 1 : -std::expm1(-x) / x;
            layer.R(i, j) =
                0.25 * albedo * phase_.opposite(i, j) * -std::expm1(-depth * (1 / nu_i + 1 / nu_j)) / (nu_i + nu_j);
            layer.D(i, j) = 0.25 * albedo * phase_.same(i, j) * layer.direct[i] * depth / (nu_i * nu_j) * mean_path;
        }
    }
    const VectorXd inverse_nu = 1 / grid_.nu, C = grid_.c;
    const MatrixXd A = 0.25 * albedo * scaled_columns(scaled_rows(inverse_nu, phase_.same), inverse_nu);
    const MatrixXd B = 0.25 * albedo * scaled_columns(scaled_rows(inverse_nu, phase_.opposite), inverse_nu);
    const MatrixXd CA = scaled_rows(C, A), CB = scaled_rows(C, B);
    layer.R += 0.5 * depth * depth * (product(A, CB) + product(B, CA));
    layer.D += 0.5 * depth * depth * (product(A, CA) + product(B, CB));
    return layer;
}

AddingDoubling::Symmetric AddingDoubling::doubled(const Symmetric& half) const {
    const VectorXd C = grid_.c, e = half.direct;
    const Interface light = between({half.R, half.R, half.D, half.D, half.direct}, half.R, grid_.c);
    Symmetric whole;
    whole.depth = 2 * half.depth;
    whole.R = half.R + scaled_rows(e, light.up) + product(half.D, scaled_rows(C, light.up));
    whole.D = scaled_rows(e, light.down) + scaled_columns(half.D, e) + product(half.D, scaled_rows(C, light.down));
    whole.direct = (-whole.depth / grid_.nu).exp();
    return whole;
}

LayerResponse AddingDoubling::layer(const Medium& medium, double thickness_mm) const {
    VOXTONE_EXPECT(thickness_mm >= 0);
    const Medium scaled = phase_.scaled(medium);
    const double depth = scaled.sigma_t() * thickness_mm;
    const int doublings = depth > first_depth ? static_cast<int>(std::ceil(std::log2(depth / first_depth))) : 0;
    Symmetric slab = thin(scaled.albedo(), std::ldexp(depth, -doublings));
    for (int k = 0; k < doublings; ++k) slab = doubled(slab);
    return {slab.R, slab.R, slab.D, slab.D, slab.direct};
}

MatrixXd AddingDoubling::half_space(const Medium& medium) const {
    VOXTONE_EXPECT(medium.sigma_t() > 0);
    Symmetric slab = thin(phase_.scaled(medium).albedo(), first_depth);
    for (int k = 0; k < most_doublings; ++k) {
        const MatrixXd before = slab.R;
        slab = doubled(slab);
        // Early on a layer is thin and R grows by halves; only past a depth of 1 does a small change mean convergence.
        if (slab.depth > 1 && (slab.R - before).cwiseAbs().maxCoeff() < 1e-13) break;
    }
    return slab.R;
}

LayerResponse AddingDoubling::add(const LayerResponse& upper, const LayerResponse& lower) const {
    const VectorXd C = grid_.c, e_upper = upper.direct, e_lower = lower.direct;
    const auto scattered = [&](const MatrixXd& D, const MatrixXd& light) { return product(D, scaled_rows(C, light)); };
    const Interface from_above = between(upper, lower.R_above, grid_.c);
    // Lit from below: the same with the layers turned over.
    const LayerResponse turned{lower.R_below, lower.R_above, lower.D_up, lower.D_down, lower.direct};
    const Interface from_below = between(turned, upper.R_below, grid_.c);
    LayerResponse both;
    both.R_above = upper.R_above + scaled_rows(e_upper, from_above.up) + scattered(upper.D_up, from_above.up);
    both.D_down = scaled_rows(e_lower, from_above.down) + scaled_columns(lower.D_down, e_upper) +
                  scattered(lower.D_down, from_above.down);
    both.R_below = lower.R_below + scaled_rows(e_lower, from_below.up) + scattered(lower.D_down, from_below.up);
    both.D_up = scaled_rows(e_upper, from_below.down) + scaled_columns(upper.D_up, e_lower) +
                scattered(upper.D_up, from_below.down);
    both.direct = upper.direct * lower.direct;
    return both;
}

MatrixXd AddingDoubling::over(const LayerResponse& upper, const MatrixXd& R_below) const {
    const Interface light = between(upper, R_below, grid_.c);
    return upper.R_above + scaled_rows(upper.direct.matrix(), light.up) +
           product(upper.D_up, scaled_rows(grid_.c.matrix(), light.up));
}

}  // namespace voxtone::optics
