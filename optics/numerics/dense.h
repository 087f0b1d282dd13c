// SPDX-License-Identifier: GPL-3.0-or-later
//
// Products and solutions of dense matrices as calls that are compiled once (dense.cpp), of Eigen::MatrixXd and of
// OrdinateMatrix. Written as expressions they are compiled anew with every shape of expression around them, which is
// half of what a file of layered light takes to compile; the bits are those of the expressions.
#pragma once

#include <type_traits>

#include <Eigen/Core>

namespace voxtone::optics {

/// The column vector that goes with a matrix type.
template <class Matrix>
using ColumnOf =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, static_cast<int>(Matrix::MaxRowsAtCompileTime), 1>;

/// A B
template <class Matrix>
[[nodiscard]] Matrix product(const Matrix& A, const std::type_identity_t<Matrix>& B);
/// A x
template <class Matrix>
[[nodiscard]] ColumnOf<Matrix> image(const Matrix& A, const ColumnOf<Matrix>& x);
/// A^T B
template <class Matrix>
[[nodiscard]] Matrix transposed_product(const Matrix& A, const std::type_identity_t<Matrix>& B);
/// A B^T
template <class Matrix>
[[nodiscard]] Matrix product_transposed(const Matrix& A, const std::type_identity_t<Matrix>& B);
/// A B A^T and A^T B A
template <class Matrix>
[[nodiscard]] Matrix congruence(const Matrix& A, const std::type_identity_t<Matrix>& B);
template <class Matrix>
[[nodiscard]] Matrix transposed_congruence(const Matrix& A, const std::type_identity_t<Matrix>& B);
/// diag(s) A and A diag(s)
template <class Matrix>
[[nodiscard]] Matrix scaled_rows(const ColumnOf<Matrix>& s, const Matrix& A);
template <class Matrix>
[[nodiscard]] Matrix scaled_columns(const Matrix& A, const ColumnOf<Matrix>& s);

/// A^-1 B and A^-1 b by an LU decomposition with pivots of rows.
template <class Matrix>
[[nodiscard]] Matrix solved(const Matrix& A, const std::type_identity_t<Matrix>& B);
template <class Matrix>
[[nodiscard]] ColumnOf<Matrix> preimage(const Matrix& A, const ColumnOf<Matrix>& b);
/// A^-1 B and A^-1 b of a symmetric A by LDL^T, whose lower triangle counts.
template <class Matrix>
[[nodiscard]] Matrix symmetric_solved(const Matrix& A, const std::type_identity_t<Matrix>& B);
template <class Matrix>
[[nodiscard]] ColumnOf<Matrix> symmetric_preimage(const Matrix& A, const ColumnOf<Matrix>& b);
/// The X of least |A X - B| by a QR decomposition with pivots of columns.
template <class Matrix>
[[nodiscard]] Matrix least_squares(const Matrix& A, const std::type_identity_t<Matrix>& B);
/// The lower L with A = L L^T; A^-1 B by it; L^-1 B; L^-T B.
template <class Matrix>
[[nodiscard]] Matrix cholesky_factor(const Matrix& A);
template <class Matrix>
[[nodiscard]] Matrix cholesky_solved(const Matrix& A, const std::type_identity_t<Matrix>& B);
template <class Matrix>
[[nodiscard]] Matrix lower_solved(const Matrix& L, const std::type_identity_t<Matrix>& B);
template <class Matrix>
[[nodiscard]] Matrix lower_transposed_solved(const Matrix& L, const std::type_identity_t<Matrix>& B);

}  // namespace voxtone::optics
