// SPDX-License-Identifier: GPL-3.0-or-later
//
// The least of a convex quadratic function under linear inequalities,
//
//   minimise  p A p / 2 + g p   where  C p >= c,
//
// by C. Hildreth's method ("A quadratic programming procedure", Naval Research Logistics Quarterly 4, 79 (1957)):
// coordinate ascent on the dual, one multiplier after the other, each set to what its own limit asks for. For a dozen
// unknowns and limits that is all there is to it. The method is exact in the limit; sweeps end when no multiplier
// changes any more, or after 500, so limits may be broken by rounding, or by more where they contradict each other.
#pragma once

#include <Eigen/Core>

namespace voxtone::scattering {

/// `A` symmetric and positive definite. A row of `C` that is zero is no limit.
[[nodiscard]] Eigen::VectorXd hildreth_minimum(const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                                               const Eigen::MatrixXd& C, const Eigen::VectorXd& c);

}  // namespace voxtone::scattering
