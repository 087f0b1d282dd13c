// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/quadrature.h"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "base/contracts.h"

namespace voxtone::optics {

namespace {

// Golub-Welsch: nodes are the eigenvalues of the Jacobi matrix of the Legendre polynomials, weights the squares of the
// first components of its eigenvectors. A Radau rule at the right end alters the last diagonal entry to n / (2n - 1).
Rule legendre_rule(int n, double last_diagonal, double a, double b) {
    VOXTONE_EXPECT(n >= 1 && b > a);
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n), off_diagonal(n - 1);
    diagonal[n - 1] = last_diagonal;
    for (int k = 1; k < n; ++k) off_diagonal[k - 1] = k / std::sqrt(4.0 * k * k - 1);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, off_diagonal);
    Rule rule{std::vector<double>(static_cast<std::size_t>(n)), std::vector<double>(static_cast<std::size_t>(n))};
    for (int k = 0; k < n; ++k) {
        const double first = solver.eigenvectors()(0, k);
        rule.x[static_cast<std::size_t>(k)] = a + 0.5 * (b - a) * (1 + solver.eigenvalues()[k]);
        rule.w[static_cast<std::size_t>(k)] = (b - a) * first * first;
    }
    return rule;
}

}  // namespace

Rule gauss_legendre(int n, double a, double b) { return legendre_rule(n, 0, a, b); }

Rule gauss_radau(int n, double a, double b) {
    Rule rule = legendre_rule(n, n / (2.0 * n - 1), a, b);
    rule.x.back() = b;
    return rule;
}

}  // namespace voxtone::optics
