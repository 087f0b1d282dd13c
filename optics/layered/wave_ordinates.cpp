// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/wave_ordinates.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/contracts.h"
#include "optics/layered/phase.h"
#include "optics/numerics/dense.h"
#include "optics/numerics/quadrature.h"

namespace voxtone::optics {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;

// Optical depth of scattering below which it is left out.
constexpr double no_scattering = 1e-4;
// Of the generator times the first layer; what it misses is the square of that.
constexpr double first_step = 1e-3;

/// sqrt((l - m)! / (l + m)!) P_l^m of all directions, l = m, m + 1, ... below `terms`.
std::vector<ArrayXd> legendre(const ArrayXd& nu, int m, int terms) {
    std::vector<ArrayXd> P;
    ArrayXd first = ArrayXd::Ones(nu.size());
    for (int i = 1; i <= m; ++i) first *= std::sqrt((2 * i - 1) / (2.0 * i)) * (1 - nu * nu).sqrt();
    for (int l = m; l < terms; ++l) {
        if (l == m) {
            P.push_back(first);
        } else if (l == m + 1) {
            P.emplace_back(std::sqrt(2.0 * m + 1) * nu * first);
        } else {
            const double last = std::sqrt(double(l - 1) * (l - 1) - double(m) * m);
            const ArrayXd next = ((2 * l - 1) * nu * P[P.size() - 1] - last * P[P.size() - 2]) /
                                 std::sqrt(double(l) * l - double(m) * m);
            P.push_back(next);
        }
    }
    return P;
}

/// Scattering of order m into the same and the other hemisphere: henyey_greenstein (phase.h) is that of order 0.
PhaseMatrices phase_of_order(const ArrayXd& nu, double g, int m, int terms, double truncated) {
    const Eigen::Index n = nu.size();
    PhaseMatrices h{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n), truncated};
    const auto P = legendre(nu, m, terms);
    for (std::size_t i = 0; i < P.size(); ++i) {
        const int l = m + static_cast<int>(i);
        const double weight = (2 * l + 1) * (std::pow(g, l) - truncated) / (1 - truncated);
        const MatrixXd term = weight * P[i].matrix() * P[i].matrix().transpose();
        h.same += term;
        h.opposite += (l + m) % 2 == 0 ? term : MatrixXd(-term);
    }
    return h;
}

}  // namespace

WaveOrdinates::WaveOrdinates(AngularGrid grid, double g, int orders) : grid_(std::move(grid)), orders_(orders) {
    VOXTONE_EXPECT(orders >= 1 && (grid_.c > 0).all());
    const int n = grid_.size(), terms = 2 * n;
    const PhaseMatrices around = conserving_henyey_greenstein(grid_, g, terms);
    truncated_ = around.truncated;
    same_ = opposite_ = sideways_ = MatrixXd::Zero(size(), size());
    inverse_nu_ = (1 / grid_.nu).matrix().replicate(orders, 1);
    const ArrayXd weight = grid_.c / (4 * grid_.nu), sine = (1 - grid_.nu * grid_.nu).sqrt();
    for (int m = 0; m < orders; ++m) {
        const PhaseMatrices h = m == 0 ? around : phase_of_order(grid_.nu, g, m, terms, truncated_);
        same_.block(m * n, m * n, n, n) = scaled_columns(h.same, weight.matrix());
        opposite_.block(m * n, m * n, n, n) = scaled_columns(h.opposite, weight.matrix());
        if (m + 1 == orders) break;
        const double shared = m == 0 ? std::numbers::sqrt2 / 2 : 0.5;
        sideways_.block((m + 1) * n, m * n, n, n) = (shared * sine).matrix().asDiagonal();
        sideways_.block(m * n, (m + 1) * n, n, n) = (-shared * sine).matrix().asDiagonal();
    }
}

bool WaveOrdinates::is_unscattering(const Medium& medium, double thickness_mm) {
    return medium.sigma_s * thickness_mm < no_scattering;
}

// Below a thin layer of depth d, dI/dz = -A I + B I' for light that goes on and light that comes: T = 1 - A d + (A^2 +
// B^2) d^2 / 2, R = B d - (A B + B A) d^2 / 2.
LayerWaves WaveOrdinates::layer(const Medium& medium, double thickness_mm, double k_per_mm) const {
    VOXTONE_EXPECT(thickness_mm >= 0 && k_per_mm >= 0);
    if (is_unscattering(medium, thickness_mm)) return unscattered(medium, thickness_mm, k_per_mm);
    const double sigma_s = medium.sigma_s * (1 - truncated_);
    MatrixXd A = 2 * std::numbers::pi * k_per_mm * sideways_ - sigma_s * same_;
    A.diagonal().array() += medium.sigma_a + sigma_s;
    A = scaled_rows(inverse_nu_, A);
    const MatrixXd B = sigma_s * scaled_rows(inverse_nu_, opposite_);
    const double steepest = A.cwiseAbs().rowwise().sum().maxCoeff() * thickness_mm;
    const int doublings = std::max(0, static_cast<int>(std::ceil(std::log2(steepest / first_step))));
    const double d = std::ldexp(thickness_mm, -doublings);
    LayerWaves layer{B * d - (product(A, B) + product(B, A)) * (0.5 * d * d),
                     (product(A, A) + product(B, B)) * (0.5 * d * d) - A * d};
    layer.T.diagonal().array() += 1;
    for (int i = 0; i < doublings; ++i) layer = doubled(layer);
    return layer;
}

LayerWaves WaveOrdinates::doubled(const LayerWaves& half) {
    const Eigen::Index n = half.R.rows();
    const MatrixXd down = solved(MatrixXd(MatrixXd::Identity(n, n) - product(half.R, half.R)), half.T);
    return {half.R + product(half.T, product(half.R, down)), product(half.T, down)};
}

// Between orders m and m', N N' / 2 ((-1)^m' J_{m + m'}(x) +- J_{|m - m'|}(x)), x = 2 pi k t tan(theta), N^2 = 2 but
// for order 0; minus where m' - m is odd and above 0.
LayerWaves WaveOrdinates::unscattered(const Medium& medium, double thickness_mm, double k_per_mm) const {
    constexpr int within_band = 24;
    const int n = grid_.size();
    LayerWaves layer{MatrixXd::Zero(size(), size()), MatrixXd::Zero(size(), size())};
    double band = 0;  // nu^2 where it begins; its width is the direction's share of the flux
    for (int i = 0; i < n; ++i) {
        const Rule squares = gauss_legendre(within_band, band, band + grid_.c[i]);
        band += grid_.c[i];
        for (std::size_t q = 0; q < squares.x.size(); ++q) {
            const double nu = std::sqrt(std::min(squares.x[q], 1.0)), share = squares.w[q] / grid_.c[i];
            const double left = share * std::exp(-medium.sigma_a * thickness_mm / nu);
            const double x = 2 * std::numbers::pi * k_per_mm * thickness_mm * std::sqrt(1 - nu * nu) / nu;
            std::vector<double> J;
            for (int order = 0; order < 2 * orders_; ++order) J.push_back(::jn(order, x));
            for (int to = 0; to < orders_; ++to)
                for (int from = 0; from < orders_; ++from) {
                    const double norm = (to == 0 ? 1 : std::numbers::sqrt2) * (from == 0 ? 1 : std::numbers::sqrt2);
                    const double sum = (to % 2 == 0 ? 1 : -1) * J[static_cast<std::size_t>(to + from)];
                    const double difference =
                        (to > from && (to - from) % 2 == 1 ? -1 : 1) * J[static_cast<std::size_t>(std::abs(to - from))];
                    layer.T(to * n + i, from * n + i) += left * 0.5 * norm * (sum + difference);
                }
        }
    }
    return layer;
}

Eigen::VectorXd WaveOrdinates::all_around(const Eigen::ArrayXd& by_direction) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(size());
    values.head(grid_.size()) = by_direction.matrix();
    return values;
}

Eigen::VectorXd WaveOrdinates::mirrored(const Eigen::ArrayXd& reflectance) const {
    return reflectance.matrix().replicate(orders_, 1);
}

WavesBelow WavesBelow::under(const LayerWaves& layer) const {
    const Eigen::Index n = R.rows();
    const MatrixXd down = solved(MatrixXd(MatrixXd::Identity(n, n) - product(layer.R, R)), layer.T);
    return {layer.R + product(layer.T, product(R, down)), leaving * down};
}

}  // namespace voxtone::optics
