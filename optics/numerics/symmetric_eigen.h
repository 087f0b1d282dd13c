// SPDX-License-Identifier: GPL-3.0-or-later
//
// Eigenvalues and eigenvectors of a small dense symmetric matrix: Householder reduction to tridiagonal form and QL
// iterations with implicit shifts (Bowdler, Martin, Reinsch, Wilkinson 1968, Numer. Math. 11:293), with the loops over
// eigenvector components innermost and contiguous. 8 to 24 rows take Eigen's SelfAdjointEigenSolver on the same
// type 1.3 to 1.4 times as long, and LayerModes with it about 1.2 to 1.3 times
// (build/release/benchmarks/optics_benchmark
// --benchmark_filter='symmetric_eigen|modes_of', processor time).
//
// Accuracy: |K q - lambda q| within some 1e-15 of the largest eigenvalue. Rows are taken in reverse, so that a matrix
// whose large entries come first, as those of layer_modes.h, loses least.
#pragma once

#include <Eigen/Core>

namespace voxtone::optics {

/// Most directions per hemisphere that the fast solver takes.
inline constexpr int max_ordinates = 32;

using OrdinateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_ordinates, max_ordinates>;
using OrdinateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_ordinates, 1>;

struct SymmetricEigen {
    OrdinateVector values;   ///< ascending
    OrdinateMatrix vectors;  ///< columns, orthonormal
};

/// `matrix` is symmetric, of 1 to max_ordinates rows.
[[nodiscard]] SymmetricEigen symmetric_eigen(const OrdinateMatrix& matrix);

}  // namespace voxtone::optics
