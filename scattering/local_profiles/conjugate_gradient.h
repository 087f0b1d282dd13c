// SPDX-License-Identifier: GPL-3.0-or-later
//
// Preconditioned conjugate gradients for A x = b, A symmetric and positive definite, known by its products alone
// (M. R. Hestenes, E. Stiefel, J. Res. Natl. Bur. Stand. 49, 409 (1952); G. Golub, C. Van Loan, "Matrix Computations",
// 4th ed. 2013, Sec. 11.5).
//
// Not Eigen's, which takes an operator too: its inner products run on one thread in an order that the width of vectors
// decides, where the caller's here run in parallel in an order of their own; and it measures residuals by their length,
// where these are measured in the norm of the preconditioner, r M^-1 r, which does not depend on the units of unknowns.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace voxtone::scattering {

/// Starts from x = 0 and ends when the square of the residual's norm has fallen by `tolerance`^2, after
/// `most_iterations`, or where rounding leaves A without curvature. `multiply(d, out)`: A d; `precondition(r, out)`:
/// M^-1 r; `dot(a, b)`: the inner product. Returns how many iterations it took.
template <class Multiply, class Precondition, class Dot>
int conjugate_gradient(std::vector<double> b, std::vector<double>& x, const Multiply& multiply,
                       const Precondition& precondition, const Dot& dot, double tolerance, int most_iterations) {
    const std::size_t n = b.size();
    std::vector<double> r = std::move(b), z(n), h(n);
    x.assign(n, 0.0);
    precondition(r, z);
    std::vector<double> d = z;
    double rz = dot(r, z);
    const double enough = tolerance * tolerance * rz;
    int iteration = 0;
    while (iteration < most_iterations && rz > enough) {
        multiply(d, h);
        const double curvature = dot(d, h);
        if (!(curvature > 0)) break;
        const double step = rz / curvature;
        for (std::size_t i = 0; i < n; ++i) x[i] += step * d[i], r[i] -= step * h[i];
        precondition(r, z);
        const double next = dot(r, z);
        for (std::size_t i = 0; i < n; ++i) d[i] = z[i] + next / rz * d[i];
        rz = next;
        ++iteration;
    }
    return iteration;
}

}  // namespace voxtone::scattering
