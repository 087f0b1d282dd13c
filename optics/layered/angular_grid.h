// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions for layered light transport.
//
// The radiance in a layer under a refractive surface has an edge at the critical angle: the transmittance of the
// surface rises there like sqrt(nu - nu_c). A rule in the cosine nu inside the resin therefore converges slowly. Nodes
// that are placed in the cosine mu in *air* see a smooth function and converge exponentially:
//
//   nu = sqrt(1 - (1 - mu^2)/eta^2),   c = 2 nu dnu = 2 mu dmu / eta^2
//
// The trapped directions, nu in (0, nu_c), take Gauss nodes in s, nu = nu_c s^2: light in thin layers varies like
// exp(-tau/nu), fastest where nu is small. c_k is the flux weight: a radiance I(nu) carries the flux sum_k c_k I_k (in
// units of pi), and sum_k c_k = 1. Largest errors of the reflectance factor 45 -> 0 (directional_test.cpp), views
// exactly at 45 and 0 degrees: 13 nodes 1e-6 for calibration patches (0.675 mm of resin) and 2e-5 for stacks of films
// of 27 um; 20 nodes 2e-6 for all.
#pragma once

#include <span>

#include <Eigen/Core>

namespace voxtone::optics {

/// Directions of one hemisphere inside a resin of index eta under a smooth surface to air, ascending in nu.
struct AngularGrid {
    double eta = 1;
    Eigen::ArrayXd nu;  ///< cosine inside the resin
    Eigen::ArrayXd c;   ///< flux weight 2 nu dnu; 0 for nodes that only look
    Eigen::ArrayXd mu;  ///< cosine in air; 0 for trapped directions
    Eigen::ArrayXd r;   ///< reflectance of the surface; 1 for trapped directions
    Eigen::ArrayXd t;   ///< 1 - r
    int trapped = 0;    ///< the first nodes, beyond the critical angle

    [[nodiscard]] int size() const { return static_cast<int>(nu.size()); }
    /// Index of the node with this cosine in air (within 1e-12); a contract that there is one.
    [[nodiscard]] int find(double mu_air) const;
};

/// `below` Gauss nodes of trapped directions, `above` of escaping ones, and nodes of weight `look_weight` at each of
/// the cosines `look` in air. Where eta is 1 nothing is trapped and all below + above nodes are one Gauss rule on (0,
/// 1).
[[nodiscard]] AngularGrid angular_grid(double eta, int below, int above, std::span<const double> views = {},
                                       double view_weight = 0);

/// Nodes with weight exactly at 45 and 0 degrees in air: `below` trapped ones, then Radau rules of `outer` nodes on
/// (0, cos 45] and `inner` on (cos 45, 1] in the air cosine. 7 + 5 + 3 gives calibration patches within 6e-6. For
/// tests: another rule with the same views, by which that of looking nodes is checked.
[[nodiscard]] AngularGrid angular_grid_45_0(double eta, int below, int outer, int inner);

}  // namespace voxtone::optics
