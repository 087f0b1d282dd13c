// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gauss rules, integral of f over (a, b) = sum_k w_k f(x_k): nodes are the eigenvalues of the Jacobi matrix of the
// Legendre polynomials, weights the squared first components of its eigenvectors (Golub and Welsch 1969; with an end
// point among the nodes: Golub 1973). Moments of up to 100 nodes are right within 1e-12 (quadrature_test.cpp).
#pragma once

#include <vector>

namespace voxtone::optics {

/// Nodes (ascending) and weights of an integration rule.
struct Rule {
    std::vector<double> x;
    std::vector<double> w;
};

/// Gauss-Legendre rule of n >= 1 nodes on (a, b): exact for polynomials of degree 2n - 1. Golub and Welsch 1969.
[[nodiscard]] Rule gauss_legendre(int n, double a, double b);

/// Radau rule of n >= 1 nodes on (a, b], of which the last is b: exact for polynomials of degree 2n - 2. Golub 1973.
/// For angular_grid_45_0.
[[nodiscard]] Rule gauss_radau(int n, double a, double b);

}  // namespace voxtone::optics
