// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/hankel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>

#include "base/contracts.h"
#include "base/random.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr double pi = std::numbers::pi;

// One unit of light spread as a Gaussian of variance s^2 on each axis, and as exp(-r / L).
double gaussian(double r, double s) { return std::exp(-0.5 * r * r / (s * s)) / (2 * pi * s * s); }
double gaussian_hat(double k, double s) { return std::exp(-2 * pi * pi * s * s * k * k); }
double exponential(double r, double L) { return std::exp(-r / L) / (2 * pi * L * L); }
double exponential_hat(double k, double L) { return std::pow(1 + std::pow(2 * pi * k * L, 2), -1.5); }

template <class F>
std::vector<double> at(std::span<const double> places, F&& f) {
    std::vector<double> values;
    for (const double x : places) values.push_back(f(x));
    return values;
}

template <class F>
std::vector<double> evenly(std::size_t n, double spacing, F&& f) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(f(static_cast<double>(i) * spacing));
    return values;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

}  // namespace

TEST_CASE("Samples and Hankel coefficients say the same: any round trip is the identity") {
    for (const std::size_t n : {2u, 17u, 64u, 256u}) {
        const HankelGrid grid(12.5, n);
        std::vector<double> samples;
        for (std::uint64_t i = 0; i < n; ++i) samples.push_back(RandomStream(3, i).uniform());
        const std::vector<double> coefficients = grid.from_radii(samples);
        const std::vector<double> again = at(grid.radii(), [&](double r) { return grid.profile(coefficients, r); });
        INFO(n << " samples, " << largest_difference(samples, again));
        CHECK(largest_difference(samples, again) < 1e-11);
        CHECK(grid.k().front() == 0);
        CHECK(std::is_sorted(grid.k().begin(), grid.k().end()));
        CHECK(std::is_sorted(grid.radii().begin(), grid.radii().end()));
        CHECK(grid.radii().front() > 0);
        CHECK(grid.radii().back() < 12.5);
    }
}

TEST_CASE("A Gaussian and its transform are known") {
    const HankelGrid grid(10, 96);
    const std::vector<double> exact = at(grid.k(), [](double k) { return gaussian_hat(k, 0.8); });
    const std::vector<double> found = grid.from_radii(at(grid.radii(), [](double r) { return gaussian(r, 0.8); }));
    CHECK(largest_difference(found, exact) < 1e-12);
    for (const double r : {0.0, 0.1, 0.8, 2.0, 5.0}) {
        CHECK(grid.profile(exact, r) == Approx(gaussian(r, 0.8)).margin(1e-12));
        CHECK(grid.light_within(exact, r) == Approx(1 - std::exp(-0.5 * r * r / 0.64)).margin(1e-12));
    }
    // A Gaussian 1 % wider is not the same.
    CHECK(largest_difference(found, at(grid.k(), [](double k) { return gaussian_hat(k, 0.808); })) > 1e-3);
}

TEST_CASE("Spreading twice is a product of coefficients") {
    const HankelGrid grid(10, 96);
    const std::vector<double> one = at(grid.k(), [](double k) { return gaussian_hat(k, 0.6); });
    const std::vector<double> other = grid.from_radii(at(grid.radii(), [](double r) { return gaussian(r, 0.8); }));
    std::vector<double> both;
    for (std::size_t i = 0; i < grid.size(); ++i) both.push_back(one[i] * other[i]);
    for (const double r : {0.0, 0.5, 1.0, 3.0}) CHECK(grid.profile(both, r) == Approx(gaussian(r, 1.0)).margin(1e-11));
}

TEST_CASE("Evenly spaced samples: known pairs to the square of the spacing, the total to rounding") {
    const HankelGrid grid(12, 128);
    for (const double spacing : {0.08, 0.04, 0.02}) {
        const auto n = static_cast<std::size_t>(16 / spacing) + 1;
        const auto wide = grid.from_even(evenly(n, spacing, [](double r) { return exponential(r, 0.5); }), spacing);
        const double error = largest_difference(wide, at(grid.k(), [](double k) { return exponential_hat(k, 0.5); }));
        INFO("spacing " << spacing << ": " << error);
        // Straight lines lie above a curve f by up to spacing^2 f'' / 8; the total of f'' is 1 / L^2.
        CHECK(error < spacing * spacing / (8 * 0.25));
        CHECK(error > 0.3 * spacing * spacing / (8 * 0.25));
    }
    // The integral of straight lines times r, summed by hand.
    std::vector<double> rough;
    for (std::uint64_t i = 0; i < 40; ++i) rough.push_back(RandomStream(5, i).uniform());
    double total = 0;
    for (std::size_t i = 0; i + 1 < rough.size(); ++i) {
        const double a = static_cast<double>(i), b = a + 1;
        total += 2 * pi * 0.09 * ((2 * a + b) * rough[i] + (a + 2 * b) * rough[i + 1]) / 6;
    }
    CHECK(grid.from_even(rough, 0.3)[0] == Approx(total).epsilon(1e-13));
    // Wide spacing, fast waves: a cone of height 1 up to r = 1 has the transform of its rings.
    std::vector<double> edges{0}, light;
    for (int i = 0; i < 4000; ++i) {
        const double a = edges.back(), b = (i + 1) / 4000.0;
        light.push_back(pi * (b * b - a * a) * (1 - (a + b) / 2));
        edges.push_back(b);
    }
    CHECK(largest_difference(grid.from_even(std::vector<double>{1, 0}, 1.0), grid.from_rings(edges, light)) < 1e-7);
}

TEST_CASE("Rings: the total is the sum, rings of one brightness are a disc") {
    const HankelGrid grid(6, 64);
    const std::vector<double> edges{0, 0.2, 0.7, 2.0};
    std::vector<double> light;
    for (std::size_t i = 0; i < 3; ++i) light.push_back(pi * (edges[i + 1] * edges[i + 1] - edges[i] * edges[i]));
    const std::vector<double> rings = grid.from_rings(edges, light);
    CHECK(rings[0] == Approx(4 * pi).epsilon(1e-15));
    for (std::size_t i = 1; i < grid.size(); ++i)
        CHECK(rings[i] == Approx(2 * std::cyl_bessel_j(1, 2 * pi * grid.k()[i] * 2) / grid.k()[i]).margin(1e-11));
}

TEST_CASE("Tails: what is cut off is missing in the total, what lies beyond the rim is folded inwards") {
    const double L = 2;
    const HankelGrid grid(10, 160);
    // Samples to 10 mm only: (1 + x) exp(-x) of the light, x = 5, is 4 %.
    const auto cut = grid.from_even(evenly(1001, 0.01, [&](double r) { return exponential(r, L); }), 0.01);
    CHECK(1 - cut[0] == Approx(6 * std::exp(-5)).margin(1e-5));
    // Samples to 40 mm: nothing is missing, and coefficients are those of the endless plane.
    const auto whole = grid.from_even(evenly(4001, 0.01, [&](double r) { return exponential(r, L); }), 0.01);
    CHECK(largest_difference(whole, at(grid.k(), [&](double k) { return exponential_hat(k, L); })) < 1e-5);
    CHECK(grid.light_within(whole, 10) == Approx(whole[0]).epsilon(1e-12));
    // The way back: right within half the reach, more than half too much at the rim.
    for (const double r : {0.5, 2.0, 5.0})
        CHECK(grid.profile(whole, r) == Approx(exponential(r, L)).margin(0.02 * exponential(5, L) + 1e-5));
    CHECK(grid.profile(whole, 10) > 1.5 * exponential(10, L));
}

TEST_CASE("A blur takes the ripples of a profile that rises like 1/r, and leaves its tail") {
    const HankelGrid grid(10, 128);
    // exp(-r / L) / (2 pi L r) has the transform 1 / sqrt(1 + (2 pi k L)^2).
    const double L = 0.4, s = 1.5 * 10 / 128;
    const auto peaked = [&](double r) { return std::exp(-r / L) / (2 * pi * L * r); };
    const std::vector<double> sharp = at(grid.k(), [&](double k) { return 1 / std::hypot(1, 2 * pi * k * L); });
    const std::vector<double> soft = grid.blurred(sharp, s);
    double worst_sharp = 0, worst_soft = 0;
    for (double r = 2; r < 3.5; r += 0.05) {
        worst_sharp = std::max(worst_sharp, std::abs(grid.profile(sharp, r) / peaked(r) - 1));
        worst_soft = std::max(worst_soft, std::abs(grid.profile(soft, r) / peaked(r) - 1));
    }
    INFO(worst_sharp << " " << worst_soft);
    CHECK(worst_sharp > 1);
    CHECK(worst_soft < 0.1);  // the blur lifts an exponential by s^2 / (2 L^2) = 4 %
    CHECK(grid.blurred(sharp, 0) == sharp);
    CHECK(soft[0] == sharp[0]);
}

TEST_CASE("A transform of the wrong size is refused") {
    CHECK_THROWS_AS(HankelGrid(0, 8), ContractViolation);
    CHECK_THROWS_AS(HankelGrid(1, 1), ContractViolation);
    const HankelGrid grid(1, 8);
    CHECK_THROWS_AS(grid.from_radii(std::vector<double>(7)), ContractViolation);
    CHECK_THROWS_AS(grid.from_even(std::vector<double>(1), 0.1), ContractViolation);
    CHECK_THROWS_AS(grid.from_rings(std::vector<double>{0, 1}, std::vector<double>{1, 2}), ContractViolation);
    CHECK_THROWS_AS(grid.profile(std::vector<double>(8), 1.1), ContractViolation);
}
