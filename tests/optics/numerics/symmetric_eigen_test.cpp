// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/symmetric_eigen.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::optics;

TEST_CASE("Symmetric matrices fall into orthonormal eigenvectors") {
    RandomStream random(9, 10);
    for (const int n : {1, 2, 3, 7, 15, 24, 32}) {
        for (const double grading : {1.0, 0.3}) {  // entries that fall by this factor from row to row
            OrdinateMatrix matrix(n, n);
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j <= i; ++j)
                    matrix(i, j) = matrix(j, i) = std::pow(grading, i + j) * (random.uniform() - 0.5);
            }
            const SymmetricEigen eigen = symmetric_eigen(matrix);
            const double size = matrix.norm();
            CHECK((matrix * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm() < 1e-14 * n * size);
            CHECK((eigen.vectors.transpose() * eigen.vectors - OrdinateMatrix::Identity(n, n)).norm() < 1e-14 * n);
            for (int k = 1; k < n; ++k) CHECK(eigen.values[k - 1] <= eigen.values[k]);
        }
    }
}

TEST_CASE("The second difference matrix has its known eigenvalues, also with splits and repeats") {
    const int n = 15;
    OrdinateMatrix matrix = OrdinateMatrix::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        matrix(i, i) = 2;
        if (i > 0) matrix(i, i - 1) = matrix(i - 1, i) = -1;
    }
    const SymmetricEigen eigen = symmetric_eigen(matrix);
    for (int k = 0; k < n; ++k) {
        CHECK(eigen.values[k] == Approx(2 - 2 * std::cos(std::numbers::pi * (k + 1) / (n + 1))).margin(1e-13));
    }
    const SymmetricEigen same = symmetric_eigen(OrdinateMatrix::Identity(n, n));
    CHECK((same.values - OrdinateVector::Ones(n)).norm() == 0);
    CHECK((same.vectors * same.vectors.transpose() - OrdinateMatrix::Identity(n, n)).norm() < 1e-14);
}
