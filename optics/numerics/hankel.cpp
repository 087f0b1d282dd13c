// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/hankel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

#include "base/contracts.h"
#include "optics/numerics/quadrature.h"

namespace voxtone::optics {
namespace {

using std::numbers::pi;

// The s-th zero of J0 or J1, s >= 1: McMahon's expansion (Abramowitz and Stegun 9.5.12) made exact by Newton's method.
double bessel_zero(int order, std::size_t s) {
    const double beta = (static_cast<double>(s) + 0.5 * order - 0.25) * pi, mu = 4.0 * order * order;
    double x = beta - (mu - 1) / (8 * beta);
    for (int step = 0; step < 6; ++step) x += order == 0 ? ::j0(x) / ::j1(x) : -::j1(x) / (::j0(x) - ::j1(x) / x);
    return x;
}

// Integral of 2 pi r J0(2 pi k r) from 0 to r.
double disc(double k, double r) { return k > 0 ? r * ::j1(2 * pi * k * r) / k : pi * r * r; }

}  // namespace

HankelGrid::HankelGrid(double reach_mm, std::size_t n) : reach_mm_(reach_mm) {
    VOXTONE_EXPECT(reach_mm > 0 && std::isfinite(reach_mm));
    VOXTONE_EXPECT(n >= 2);
    const double next = bessel_zero(1, n);
    for (std::size_t i = 0; i < n; ++i) {
        const double j = i == 0 ? 0 : bessel_zero(1, i), J0 = ::j0(j);
        k_.push_back(j / (2 * pi * reach_mm));
        norm_.push_back(1 / (pi * reach_mm * reach_mm * J0 * J0));
        radii_.push_back(reach_mm * bessel_zero(0, i + 1) / next);
    }
    const auto size = static_cast<Eigen::Index>(n);
    Eigen::MatrixXd series(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
        for (Eigen::Index s = 0; s < size; ++s) {
            const auto wave = static_cast<std::size_t>(i), sample = static_cast<std::size_t>(s);
            series(s, i) = norm_[wave] * ::j0(2 * pi * k_[wave] * radii_[sample]);
        }
    inverse_.resize(n * n);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(inverse_.data(), size, size) =
        series.partialPivLu().inverse();
}

std::vector<double> HankelGrid::from_radii(std::span<const double> f) const {
    const std::size_t n = size();
    VOXTONE_EXPECT(f.size() == n);
    std::vector<double> coefficients(n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t s = 0; s < n; ++s) coefficients[i] += inverse_[i * n + s] * f[s];
    return coefficients;
}

std::vector<double> HankelGrid::from_even(std::span<const double> f, double spacing_mm) const {
    VOXTONE_EXPECT(f.size() >= 2 && spacing_mm > 0);
    // r times a straight line times J0: eight nodes are exact for degree 15, and enough where the fastest wave turns by
    // up to pi.
    const int pieces = 1 + static_cast<int>(2 * k_.back() * spacing_mm);
    const Rule rule = gauss_legendre(8, 0, 1);
    std::vector<double> r, light;
    for (std::size_t s = 0; s + 1 < f.size(); ++s)
        for (int piece = 0; piece < pieces; ++piece)
            for (std::size_t q = 0; q < rule.x.size(); ++q) {
                const double at = (piece + rule.x[q]) / pieces;
                r.push_back((static_cast<double>(s) + at) * spacing_mm);
                light.push_back(2 * pi * r.back() * (f[s] + at * (f[s + 1] - f[s])) * rule.w[q] * spacing_mm / pieces);
            }
    std::vector<double> coefficients(size());
    for (std::size_t i = 0; i < size(); ++i)
        for (std::size_t q = 0; q < r.size(); ++q) coefficients[i] += light[q] * ::j0(2 * pi * k_[i] * r[q]);
    return coefficients;
}

std::vector<double> HankelGrid::from_rings(std::span<const double> edges_mm, std::span<const double> light) const {
    VOXTONE_EXPECT(edges_mm.size() == light.size() + 1 && edges_mm.front() >= 0);
    std::vector<double> coefficients(size());
    for (std::size_t ring = 0; ring < light.size(); ++ring) {
        const double inner = edges_mm[ring], outer = edges_mm[ring + 1];
        VOXTONE_EXPECT(outer > inner);
        const double per_area = light[ring] / (pi * (outer - inner) * (outer + inner));
        coefficients[0] += light[ring];
        if (light[ring] == 0) continue;
        for (std::size_t i = 1; i < size(); ++i)
            coefficients[i] += per_area * (disc(k_[i], outer) - disc(k_[i], inner));
    }
    return coefficients;
}

std::vector<double> HankelGrid::blurred(std::span<const double> coefficients, double s_mm) const {
    VOXTONE_EXPECT(coefficients.size() == size() && s_mm >= 0);
    std::vector<double> result(coefficients.begin(), coefficients.end());
    for (std::size_t i = 0; i < size(); ++i) result[i] *= std::exp(-2 * pi * pi * s_mm * s_mm * k_[i] * k_[i]);
    return result;
}

double HankelGrid::profile(std::span<const double> coefficients, double r_mm) const {
    VOXTONE_EXPECT(coefficients.size() == size() && r_mm >= 0 && r_mm <= reach_mm_);
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) sum += coefficients[i] * norm_[i] * ::j0(2 * pi * k_[i] * r_mm);
    return sum;
}

double HankelGrid::light_within(std::span<const double> coefficients, double r_mm) const {
    VOXTONE_EXPECT(coefficients.size() == size() && r_mm >= 0 && r_mm <= reach_mm_);
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) sum += coefficients[i] * norm_[i] * disc(k_[i], r_mm);
    return sum;
}

}  // namespace voxtone::optics
