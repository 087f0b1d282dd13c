// SPDX-License-Identifier: GPL-3.0-or-later
//
// An observer of few bands for measured spectra, which give it outright: nothing of it is fitted together with resins.
// K of the measured wavelengths are nodes of a quadrature,
//
//   XYZ_k / white_k = sum_c w_ck rho(lambda_c),   w >= 0,   sum_c w_ck = 1
//
// chosen, nodes and weights, so that the spectra that were measured have the colour that all wavelengths give them:
// least squares of differences of CIELAB's roots, node by node exchanged for another as long as that helps. What resins
// reflect is smooth: few nodes do, but not even steps.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

struct ObserverBands {
    std::vector<Eigen::Index> nodes;  ///< columns of the spectra, ascending
    Eigen::MatrixX3d weights;         ///< bands x 3, columns sum to 1
};

/// `spectra`: a mixture a row, a wavelength a column. `observer`: wavelengths x 3, columns sum to 1. Contract: 3 <=
/// bands <= wavelengths.
[[nodiscard]] ObserverBands observer_bands(const Eigen::MatrixXd& spectra, const Eigen::MatrixX3d& observer,
                                           Eigen::Index bands);

}  // namespace voxtone::calibration
