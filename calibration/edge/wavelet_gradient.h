// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gradient of a noisy profile by a wavelet, as Eq. 2 of Elek et al. 2017 (supplement) wants it "by the method of
// Luo et al. 2006 based on discrete wavelet decomposition" (J. Luo, J. Bai, J. Shao, Application of the wavelet
// transforms on axial strain calculation in ultrasound elastography, Prog. Nat. Sci. 16, 942).
//
// The transform taken here: the dyadic wavelet transform without decimation (algorithme a trous) with the quadratic
// spline wavelet, the derivative of a cubic spline (S. Mallat, S. Zhong, Characterization of signals from multiscale
// edges, IEEE PAMI 14, 1992, Table I): low-pass h = (1, 3, 3, 1)/8, high-pass g = (-1, 1), dilated by 2^j at level j.
// The detail at level L is the derivative of the profile smoothed at that scale; it is scaled so that a ramp of slope 1
// a sample gives 1. Profiles go on beyond their ends with their last values. The level is not given by the paper: 3.
// All of it is one linear filter of width 3 (2^(L-1) - 1) + 2^(L-1) + 1 samples, antisymmetric.
//
// Units: value per sample; answers lie between samples, one fewer than samples.
#pragma once

#include <Eigen/Core>

namespace voxtone::calibration {

/// The filter: gradient between samples k and k + 1 is sum_i taps[i] f[k + 1 - size/2 + i]. `level` from 1 to 8.
[[nodiscard]] Eigen::VectorXd wavelet_derivative_taps(int level);

/// The map from `samples` values to their gradients, (samples - 1) x samples.
[[nodiscard]] Eigen::MatrixXd wavelet_gradient_map(Eigen::Index samples, int level);

}  // namespace voxtone::calibration
