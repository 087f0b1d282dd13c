// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far light spreads sideways through cells that are thicker than a transport mean free path. Of a mode exp(i k x)
// of the discrete equations, in a lattice without end, the absorption sigma_a = -D k^2 that keeps it is found; its D is
// compared with 1 / (3 sigma_tr). A slab that is alike all over cannot show it: there the albedo is matched.
#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>

#include "optics/transport/transport_medium.h"
#include "optics/transport/viewing_transport.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> cell_mm{0.0846667, 0.0846667, 0.081};
constexpr double wave_mm = 20;  // so long that what D says of it is true within (sigma_tr wave / 2 pi)^-2

/// psi (sigma_t + |Omega_x| / h (1 + theta) (e - 1) / (e + theta)) = sigma_s (phi + 3 g' Omega . J), e = exp(+-i k h),
/// of a medium that neither absorbs nor makes light: the share of phi that comes back, with J made consistent.
double kept(const DirectionSet& set, double theta, double sigma_t, double sigma_s, double linear) {
    using Complex = std::complex<double>;
    const double k = 2 * std::numbers::pi / wave_mm;
    Complex of_one{}, of_x{}, of_xx{};  // sums of w / balance, w Omega_x / balance, w Omega_x^2 / balance
    for (std::size_t d = 0; d < 8; ++d)
        for (const double sign : {1.0, -1.0}) {
            const double omega = double(set.cosine[0].v[d]), w = 4 * double(set.weight.v[d]);
            const Complex e = std::exp(Complex(0, sign * k * cell_mm[0]));
            const Complex balance = sigma_t + omega / cell_mm[0] * (1 + theta) * (e - 1.0) / (e + theta);
            of_one += w / balance;
            of_x += w * sign * omega / balance;
            of_xx += w * omega * omega / balance;
        }
    // phi = sigma_s (of_one phi + 3 g' of_x J), J = sigma_s (of_x phi + 3 g' of_xx J)
    const Complex J = sigma_s * of_x / (1.0 - 3 * linear * sigma_s * of_xx);
    return (sigma_s * (of_one + 3 * linear * of_x * J)).real();
}

/// D of the discrete equations / D.
double widening(const DirectionSet& set, double theta, double sigma_t, bool corrected) {
    const double f = set.forward_peak, scatter = sigma_t * (1 - f);
    const auto linear = [&](double extinction) {
        return corrected ? anti_diffusive_linear(set, cell_mm, theta, extinction, scatter) : set.linear;
    };
    double low = -0.5 * scatter, high = 0;  // of sigma_a
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        // More absorption keeps less.
        (kept(set, theta, scatter + middle, scatter, linear(scatter)) > 1 ? low : high) = middle;
    }
    const double k = 2 * std::numbers::pi / wave_mm;
    return -low / (k * k) * 3 * scatter * (1 - set.linear);
}

}  // namespace

TEST_CASE("Light spreads sideways through thick cells as through the medium") {
    const DirectionSet set = make_directions(0.4, 1.5);
    for (const double sigma_t : {6.0, 9.0, 24.0, 40.0, 60.0, 100.0}) {
        // Diamond differences do: what their own 64 directions and this wave do to D is in both.
        const double diamond = widening(set, 1, sigma_t, true);
        INFO(sigma_t << " per mm: " << widening(set, viewing_theta, sigma_t, true) << " of D for " << diamond
                     << ", without the correction " << widening(set, viewing_theta, sigma_t, false));
        CHECK(diamond == Approx(1).margin(0.01));
        // The edge along x is 1.5 % above the mean of the three, the set's <|Omega_x|> 2.6 % above 1/2: that much of
        // the artificial D stays, of the 0.32 D that there is at 100 per mm.
        CHECK(widening(set, viewing_theta, sigma_t, true) == Approx(diamond).margin(0.005 + 0.041 * 0.0032 * sigma_t));
        CHECK(widening(set, viewing_theta, sigma_t, false) > diamond + 0.0019 * sigma_t);
    }
}

TEST_CASE("What is absorbed before it is diffuse is left as it is, and sources are never negative") {
    const DirectionSet set = make_directions(0.4, 1.5);
    CHECK(anti_diffusive_linear(set, cell_mm, 1, 60, 60) == set.linear);
    CHECK(anti_diffusive_linear(set, cell_mm, viewing_theta, 9, 0.45) == Approx(set.linear).margin(1e-6));
    CHECK(anti_diffusive_linear(set, cell_mm, viewing_theta, 50, 49.9) < set.linear - 0.1);
    for (const double sigma_t : {100.0, 200.0, 400.0, 1e4})
        CHECK(anti_diffusive_linear(set, cell_mm, viewing_theta, sigma_t, sigma_t) >= -1.0 / 3);
    const DirectionSet backward = make_directions(-0.3, 1.5);
    CHECK(anti_diffusive_linear(backward, cell_mm, viewing_theta, 60, 60) >= -1.0 / 3 - 1e-9);
}
