// SPDX-License-Identifier: GPL-3.0-or-later
//
// How scattering redistributes light among the directions of a layer, averaged over azimuth.
//
//   h(nu, nu') = sum_{k < L} (2k + 1) chi_k P_k(nu) P_k(nu'),      chi_k = (g^k - f) / (1 - f),   f = g^L
//
// for the Henyey-Greenstein function of mean cosine g, cut after L Legendre terms; what is cut off, f, lies so near the
// forward direction that it counts as not scattered (delta-M: Wiscombe 1977, J. Atmos. Sci. 34:1408): sigma_s' =
// sigma_s (1 - f). Normalisation: 1/2 sum_i w_i (h_same + h_opposite)_ij = 1 with w = c / (2 nu), what a particle
// scatters is all there.
#pragma once

#include <Eigen/Core>

#include "optics/layered/angular_grid.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

struct PhaseMatrices {
    Eigen::MatrixXd same;      ///< h(nu_i, nu_j): into the same hemisphere
    Eigen::MatrixXd opposite;  ///< h(nu_i, -nu_j): into the other one
    double truncated = 0;      ///< f, the share that counts as not scattered

    /// The medium that these matrices belong to: scattering without the forward peak.
    [[nodiscard]] Medium scaled(const Medium& medium) const {
        return {medium.sigma_a, medium.sigma_s * (1 - truncated)};
    }
};

/// The series above at cosines nu. g in (-1, 1), L = terms >= 1.
[[nodiscard]] PhaseMatrices henyey_greenstein(const Eigen::ArrayXd& nu, double g, int terms);

/// The same on a grid, with the small error of the quadrature's normalisation removed by a symmetric scaling
/// d_i h_ij d_j, so that a medium that absorbs nothing conserves energy to rounding. `correction`, if not null,
/// receives max |d - 1|.
[[nodiscard]] PhaseMatrices conserving_henyey_greenstein(const AngularGrid& grid, double g, int terms,
                                                         double* correction = nullptr);

}  // namespace voxtone::optics
