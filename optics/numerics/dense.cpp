// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "optics/numerics/symmetric_eigen.h"

namespace voxtone::optics {

template <class Matrix>
Matrix product(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A * B;
}

template <class Matrix>
ColumnOf<Matrix> image(const Matrix& A, const ColumnOf<Matrix>& x) {
    return A * x;
}

template <class Matrix>
Matrix transposed_product(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A.transpose() * B;
}

template <class Matrix>
Matrix product_transposed(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A * B.transpose();
}

template <class Matrix>
Matrix congruence(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return product_transposed(product(A, B), A);
}

template <class Matrix>
Matrix transposed_congruence(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return product(transposed_product(A, B), A);
}

template <class Matrix>
Matrix scaled_rows(const ColumnOf<Matrix>& s, const Matrix& A) {
    return s.asDiagonal() * A;
}

template <class Matrix>
Matrix scaled_columns(const Matrix& A, const ColumnOf<Matrix>& s) {
    return A * s.asDiagonal();
}

template <class Matrix>
Matrix solved(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A.partialPivLu().solve(B);
}

template <class Matrix>
ColumnOf<Matrix> preimage(const Matrix& A, const ColumnOf<Matrix>& b) {
    return A.partialPivLu().solve(b);
}

template <class Matrix>
Matrix symmetric_solved(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A.ldlt().solve(B);
}

template <class Matrix>
ColumnOf<Matrix> symmetric_preimage(const Matrix& A, const ColumnOf<Matrix>& b) {
    return A.ldlt().solve(b);
}

template <class Matrix>
Matrix least_squares(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A.colPivHouseholderQr().solve(B);
}

template <class Matrix>
Matrix cholesky_factor(const Matrix& A) {
    return A.llt().matrixL();
}

template <class Matrix>
Matrix cholesky_solved(const Matrix& A, const std::type_identity_t<Matrix>& B) {
    return A.llt().solve(B);
}

template <class Matrix>
Matrix lower_solved(const Matrix& L, const std::type_identity_t<Matrix>& B) {
    return L.template triangularView<Eigen::Lower>().solve(B);
}

template <class Matrix>
Matrix lower_transposed_solved(const Matrix& L, const std::type_identity_t<Matrix>& B) {
    return L.transpose().template triangularView<Eigen::Upper>().solve(B);
}

// What is asked for of either, no more.
#define VOXTONE_DENSE_OF(Matrix)                                                     \
    template Matrix product<Matrix>(const Matrix&, const Matrix&);                   \
    template ColumnOf<Matrix> image<Matrix>(const Matrix&, const ColumnOf<Matrix>&); \
    template Matrix scaled_rows<Matrix>(const ColumnOf<Matrix>&, const Matrix&);     \
    template Matrix scaled_columns<Matrix>(const Matrix&, const ColumnOf<Matrix>&);

VOXTONE_DENSE_OF(Eigen::MatrixXd)
template Eigen::MatrixXd solved(const Eigen::MatrixXd&, const Eigen::MatrixXd&);
template Eigen::VectorXd preimage(const Eigen::MatrixXd&, const Eigen::VectorXd&);
template Eigen::MatrixXd symmetric_solved(const Eigen::MatrixXd&, const Eigen::MatrixXd&);
template Eigen::VectorXd symmetric_preimage(const Eigen::MatrixXd&, const Eigen::VectorXd&);
template Eigen::MatrixXd least_squares(const Eigen::MatrixXd&, const Eigen::MatrixXd&);

VOXTONE_DENSE_OF(OrdinateMatrix)
template OrdinateMatrix transposed_product(const OrdinateMatrix&, const OrdinateMatrix&);
template OrdinateMatrix product_transposed(const OrdinateMatrix&, const OrdinateMatrix&);
template OrdinateMatrix congruence(const OrdinateMatrix&, const OrdinateMatrix&);
template OrdinateMatrix transposed_congruence(const OrdinateMatrix&, const OrdinateMatrix&);
template OrdinateMatrix cholesky_factor(const OrdinateMatrix&);
template OrdinateMatrix cholesky_solved(const OrdinateMatrix&, const OrdinateMatrix&);
template OrdinateMatrix lower_solved(const OrdinateMatrix&, const OrdinateMatrix&);
template OrdinateMatrix lower_transposed_solved(const OrdinateMatrix&, const OrdinateMatrix&);

}  // namespace voxtone::optics
