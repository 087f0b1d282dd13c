// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/symmetric_eigen.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/contracts.h"

namespace voxtone::optics {

namespace {

constexpr int max_n = max_ordinates;

struct Work {
    int n;
    double a[max_n][max_n];  // the matrix, then the reflections
    double z[max_n][max_n];  // row k: eigenvector k
    double d[max_n], e[max_n];
};

// Householder reflections 1 - u u^T / h, from the last row up; u is left in row i of a, h in h[i].
void tridiagonalize(Work& w, double (&h)[max_n]) {
    double p[max_n];
    for (int i = w.n - 1; i > 1; --i) {
        double* const u = w.a[i];
        double beyond = 0;  // what the reflection has to remove
        for (int k = 0; k < i - 1; ++k) beyond += u[k] * u[k];
        h[i] = 0;
        w.d[i] = u[i];
        if (beyond == 0) {
            w.e[i] = u[i - 1];
            continue;
        }
        const double length = std::sqrt(beyond + u[i - 1] * u[i - 1]);
        const double target = u[i - 1] > 0 ? -length : length;
        w.e[i] = target;
        h[i] = length * length - u[i - 1] * target;
        u[i - 1] -= target;
        // A - u q^T - q u^T with p = A u / h and q = p - u (u.p) / 2h
        for (int k = 0; k < i; ++k) p[k] = 0;
        for (int j = 0; j < i; ++j) {
            const double factor = u[j];
            for (int k = 0; k < i; ++k) p[k] += factor * w.a[j][k];
        }
        const double inverse_h = 1 / h[i];
        double dot = 0;
        for (int k = 0; k < i; ++k) {
            p[k] *= inverse_h;
            dot += u[k] * p[k];
        }
        const double half = 0.5 * dot * inverse_h;
        for (int k = 0; k < i; ++k) p[k] -= half * u[k];
        for (int j = 0; j < i; ++j) {
            const double u_j = u[j], q_j = p[j];
            for (int k = 0; k < i; ++k) w.a[j][k] -= u_j * p[k] + q_j * u[k];
        }
    }
    if (w.n > 1) {
        w.e[1] = w.a[1][0];
        w.d[1] = w.a[1][1];
        h[1] = 0;
    }
    w.d[0] = w.a[0][0];
}

// The product of the reflections; rows of z are its columns.
void accumulate(Work& w, const double (&h)[max_n]) {
    for (int i = 0; i < w.n; ++i) {
        for (int k = 0; k < w.n; ++k) w.z[i][k] = i == k;
    }
    for (int i = 2; i < w.n; ++i) {
        if (h[i] == 0) continue;
        const double* const u = w.a[i];
        const double inverse_h = 1 / h[i];
        // Only the leading i x i block of the product so far differs from the identity.
        for (int row = 0; row < i; ++row) {
            double dot = 0;
            for (int k = 0; k < i; ++k) dot += u[k] * w.z[row][k];
            const double factor = dot * inverse_h;
            for (int k = 0; k < i; ++k) w.z[row][k] -= factor * u[k];
        }
    }
}

// d: diagonal, e[1..]: below it; the rotations are applied to the rows of z.
void ql_iterations(Work& w) {
    const int n = w.n;
    double* const d = w.d;
    double* const e = w.e;
    for (int i = 1; i < n; ++i) e[i - 1] = e[i];
    e[n - 1] = 0;
    for (int l = 0; l < n; ++l) {
        for (int iteration = 0;; ++iteration) {
            int m = l;
            while (m + 1 < n &&
                   std::abs(e[m]) > std::numeric_limits<double>::epsilon() * (std::abs(d[m]) + std::abs(d[m + 1]))) {
                ++m;
            }
            if (m == l) break;
            VOXTONE_ENSURE(iteration < 60);
            double g = (d[l + 1] - d[l]) / (2 * e[l]);
            double r = std::sqrt(g * g + 1);
            g = d[m] - d[l] + e[l] / (g + std::copysign(r, g));
            double s = 1, c = 1, p = 0;
            int i = m - 1;
            for (; i >= l; --i) {
                const double f = s * e[i], b = c * e[i];
                r = std::sqrt(f * f + g * g);
                e[i + 1] = r;
                if (r == 0) {  // the matrix falls apart here
                    d[i + 1] -= p;
                    e[m] = 0;
                    break;
                }
                const double inverse_r = 1 / r;
                s = f * inverse_r;
                c = g * inverse_r;
                g = d[i + 1] - p;
                r = (d[i] - g) * s + 2 * c * b;
                p = s * r;
                d[i + 1] = g + p;
                g = c * r - b;
                double* const lower = w.z[i];
                double* const upper = w.z[i + 1];
                for (int k = 0; k < n; ++k) {
                    const double x = upper[k], y = lower[k];
                    upper[k] = s * y + c * x;
                    lower[k] = c * y - s * x;
                }
            }
            if (r == 0 && i >= l) continue;
            d[l] -= p;
            e[l] = g;
            e[m] = 0;
        }
    }
}

}  // namespace

SymmetricEigen symmetric_eigen(const OrdinateMatrix& matrix) {
    VOXTONE_EXPECT(matrix.rows() >= 1 && matrix.rows() == matrix.cols());
    const auto n = static_cast<int>(matrix.rows());
    Work w{};
    w.n = n;
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) w.a[i][k] = matrix(n - 1 - i, n - 1 - k);
    }
    double h[max_n] = {};
    tridiagonalize(w, h);
    accumulate(w, h);
    ql_iterations(w);

    int order[max_n];
    for (int k = 0; k < n; ++k) order[k] = k;
    std::sort(order, order + n, [&](int a, int b) { return w.d[a] < w.d[b]; });
    SymmetricEigen result{OrdinateVector(n), OrdinateMatrix(n, n)};
    for (int k = 0; k < n; ++k) {
        result.values[k] = w.d[order[k]];
        for (int i = 0; i < n; ++i) result.vectors(n - 1 - i, k) = w.z[order[k]][i];
    }
    return result;
}

}  // namespace voxtone::optics
