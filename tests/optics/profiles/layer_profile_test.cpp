// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/layer_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <catch2/catch.hpp>

#include "base/contracts.h"
#include "base/random.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Layers of T and R that span what there is: clear, conservative, black, opaque and all between.
struct Coefficients {
    std::vector<double> T, R;
};

Coefficients many_layers(std::uint64_t seed) {
    Coefficients layers{{1, 0.5, 0.01, 1 - 1e-9, 0.9, 1e-12, 1e-150, 1e-4}, {0, 0.5, 0.99, 1e-9, 0, 0.3, 0.999, 0}};
    for (std::uint64_t i = 0; i < 2000; ++i) {
        RandomStream random(seed, i);
        const double out = i % 4 == 0 ? 1.0 : random.uniform(), share = random.uniform();
        layers.T.push_back(i % 3 == 0 ? out * std::pow(10, -12 * share) : out * share);
        layers.R.push_back(out - layers.T.back());
    }
    return layers;
}

double largest_difference(const LayerProfile& a, const LayerProfile& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::max({worst, std::abs(a.T[i] - b.T[i]), std::abs(a.R_top[i] - b.R_top[i]),
                          std::abs(a.R_bottom[i] - b.R_bottom[i])});
    return worst;
}

HomogeneousLayer scalar(double T, double R, double mm) { return {std::vector<double>{T}, std::vector<double>{R}, mm}; }

}  // namespace

TEST_CASE("A slab cut in two and stacked again is itself within 1e-10") {
    const Coefficients known = many_layers(1);
    const HomogeneousLayer layer(known.T, known.R, 0.7);
    double worst = 0;
    for (const double whole : {0.7, 0.027, 3.1, 40.0}) {
        for (const double cut : {0.0, 1e-6, 0.1, 0.5, 0.77, 1.0}) {
            const LayerProfile again = laminate(layer.of_thickness(whole * cut), layer.of_thickness(whole * (1 - cut)));
            worst = std::max(worst, largest_difference(again, layer.of_thickness(whole)));
        }
    }
    INFO(worst);
    CHECK(worst < 1e-10);
    // The measure finds out a cut that loses a thousandth of the slab.
    CHECK(largest_difference(laminate(layer.of_thickness(0.3), layer.of_thickness(0.3993)), layer.of_thickness(0.7)) >
          1e-5);
}

TEST_CASE("A layer of the known thickness is the known layer") {
    const Coefficients known = many_layers(2);
    const LayerProfile again = HomogeneousLayer(known.T, known.R, 0.7).of_thickness(0.7);
    double worst_T = 0, worst_R = 0, relative = 0;
    for (std::size_t i = 0; i < known.T.size(); ++i) {
        worst_T = std::max(worst_T, std::abs(again.T[i] - known.T[i]));
        worst_R = std::max(worst_R, std::abs(again.R_top[i] - known.R[i]));
        // 1 - R is known to a rounding error only, and what is let through grows and falls with it.
        relative = std::max(relative, std::abs(again.T[i] / known.T[i] - 1) * (1 - known.R[i]));
        CHECK(again.R_top[i] == again.R_bottom[i]);
    }
    INFO(worst_T << " " << worst_R << ", relative " << relative);
    CHECK(worst_T < 1e-13);
    CHECK(worst_R < 1e-13);
    CHECK(relative < 1e-12);
}

TEST_CASE("K and S are the limits that halving a layer finds") {
    const Coefficients known = many_layers(3);
    const HomogeneousLayer layer(known.T, known.R, 1.0);
    for (std::size_t i = 0; i < known.T.size(); ++i) {
        if (known.T[i] < 1e-6)
            continue;  // halving starts with T + 1 and R: nothing is lost, but it takes longer to be thin
        double T = known.T[i], R = known.R[i], h = 1;
        for (int k = 0; k < 20; ++k, h /= 2) {
            R = R / (T + 1);
            T = std::sqrt(T * (1 - R * R));
        }
        const double scale = layer.K()[i] + layer.S()[i];
        INFO("T " << known.T[i] << ", R " << known.R[i]);
        CHECK(std::abs(layer.S()[i] - R / h) <= 1e-4 * (scale + scale * scale) + 1e-9);
        CHECK(std::abs(layer.K()[i] - (1 - R - T) / h) <= 1e-4 * (scale + scale * scale) + 1e-9);
    }
}

TEST_CASE("Layers follow the closed forms of Kubelka and Munk") {
    // sinh and cosh as printed in Sec. 5.2 of the paper; beta is taken in the units of alpha.
    for (const auto& [T, R] : {std::pair{0.5, 0.3}, {0.2, 0.7}, {0.05, 0.02}, {0.9, 0.05}}) {
        const HomogeneousLayer layer = scalar(T, R, 0.4);
        const double K = layer.K()[0], S = layer.S()[0];
        const double alpha = 1 + K / S, beta = std::sqrt(alpha * alpha - 1), gamma = std::sqrt(K * (K + 2 * S));
        for (const double h : {0.1, 0.4, 1.3}) {
            const LayerProfile made = layer.of_thickness(h);
            const double below = alpha * std::sinh(gamma * h) + beta * std::cosh(gamma * h);
            CHECK(made.R_top[0] == Approx(std::sinh(gamma * h) / below).epsilon(1e-11));
            CHECK(made.T[0] == Approx(beta / below).epsilon(1e-11));
        }
        CHECK(layer.of_thickness(infinity).R_top[0] == Approx(alpha - beta).epsilon(1e-11));
        CHECK(layer.of_thickness(infinity).T[0] == 0);
    }
    // Nothing absorbed: R = S h / (1 + S h). Nothing scattered: T = exp(-K h).
    const HomogeneousLayer white = scalar(0.25, 0.75, 1.0);
    CHECK(white.K()[0] == 0);
    CHECK(white.S()[0] == Approx(3).epsilon(1e-14));
    CHECK(white.of_thickness(2.0).R_top[0] == Approx(6.0 / 7).epsilon(1e-14));
    CHECK(white.of_thickness(2.0).T[0] == Approx(1.0 / 7).epsilon(1e-14));
    CHECK(white.of_thickness(infinity).R_top[0] == 1);
    const HomogeneousLayer black = scalar(std::exp(-2.0), 0, 1.0);
    CHECK(black.S()[0] == 0);
    CHECK(black.K()[0] == Approx(2).epsilon(1e-14));
    CHECK(black.of_thickness(300.0).T[0] == Approx(std::exp(-600.0)).epsilon(1e-12));
    CHECK(black.of_thickness(infinity).R_top[0] == 0);
}

TEST_CASE("Zero thickness is no layer, infinite thickness the limit of thick layers") {
    const Coefficients known = many_layers(4);
    const HomogeneousLayer layer(known.T, known.R, 0.7);
    CHECK(largest_difference(layer.of_thickness(0), no_layer(known.T.size())) == 0);
    const LayerProfile some = layer.of_thickness(0.2), none = no_layer(known.T.size());
    CHECK(largest_difference(laminate(none, some), some) == 0);
    CHECK(largest_difference(laminate(some, none), some) == 0);
    const LayerProfile endless = layer.of_thickness(infinity), thick = layer.of_thickness(1e12);
    for (std::size_t i = 0; i < known.T.size(); ++i) {
        if (known.T[i] == 1) {
            CHECK(endless.T[i] == 1);
            continue;
        }
        CHECK(endless.T[i] == 0);
        CHECK(endless.R_top[i] == Approx(thick.R_top[i]).margin(2e-3));  // the coefficient of S = 1.4e-9 is slow
        // A half-space does not change under a layer of itself.
        CHECK(laminate(some, endless).R_top[i] == Approx(endless.R_top[i]).margin(1e-12));
    }
}

TEST_CASE("No laminate gives out more light than it gets") {
    const Coefficients one = many_layers(5), other = many_layers(6);
    const HomogeneousLayer a(one.T, one.R, 0.7), b(other.T, other.R, 0.3);
    LayerProfile all = no_layer(one.T.size());
    for (int k = 0; k < 40; ++k) {
        RandomStream random(9, static_cast<std::uint64_t>(k));
        all = laminate(all, (k % 2 ? a : b).of_thickness(std::pow(10.0, 4 * random.uniform() - 3)));
        for (std::size_t i = 0; i < all.size(); ++i) {
            CHECK(all.T[i] >= 0);
            CHECK(all.R_top[i] >= 0);
            CHECK(all.R_bottom[i] >= 0);
            CHECK(all.T[i] + all.R_top[i] <= 1 + 1e-12);
            CHECK(all.T[i] + all.R_bottom[i] <= 1 + 1e-12);
        }
    }
    // Where nothing is absorbed all of it comes out.
    const LayerProfile white = laminate(scalar(0.3, 0.7, 1).of_thickness(0.2), scalar(0.9, 0.1, 1).of_thickness(4));
    CHECK(white.T[0] + white.R_top[0] == Approx(1).epsilon(1e-14));
    CHECK(white.T[0] + white.R_bottom[0] == Approx(1).epsilon(1e-14));
}

TEST_CASE("Stacking is associative, and turning a laminate over exchanges its sides") {
    const Coefficients one = many_layers(7), other = many_layers(8), last = many_layers(9);
    const LayerProfile a = HomogeneousLayer(one.T, one.R, 1).of_thickness(1);
    const LayerProfile b = HomogeneousLayer(other.T, other.R, 1).of_thickness(0.3);
    const LayerProfile c = HomogeneousLayer(last.T, last.R, 1).of_thickness(2);
    CHECK(largest_difference(laminate(laminate(a, b), c), laminate(a, laminate(b, c))) < 1e-12);
    LayerProfile turned = laminate(laminate(c, b), a);
    std::swap(turned.R_top, turned.R_bottom);
    CHECK(largest_difference(laminate(laminate(a, b), c), turned) < 1e-12);
}

TEST_CASE("Coefficients that no layer can have are clamped, and it is said by how much") {
    CHECK(scalar(0.4, 0.5, 1).clamped() == 0);
    const HomogeneousLayer negative = scalar(-0.01, 0.5, 1);
    CHECK(negative.clamped() == Approx(0.01));
    CHECK(negative.of_thickness(1).R_top[0] == Approx(0.5));
    CHECK(negative.of_thickness(1).T[0] < 1e-290);
    CHECK(scalar(0.5, -0.02, 1).clamped() == Approx(0.02));
    const HomogeneousLayer bright = scalar(0.6, 0.6, 1);  // scaled down to 0.5, 0.5
    CHECK(bright.clamped() == Approx(0.1));
    CHECK(bright.of_thickness(1).T[0] == Approx(0.5));
    CHECK(bright.of_thickness(1).R_top[0] == Approx(0.5));
    const HomogeneousLayer mirror = scalar(0, 1, 1), hole = scalar(0, 0, 1);
    for (const double mm : {1e-3, 1.0, 1e3, infinity}) {
        CHECK(mirror.of_thickness(mm).R_top[0] == Approx(1).margin(1e-9));
        CHECK(hole.of_thickness(mm).R_top[0] == 0);
        CHECK(std::isfinite(hole.of_thickness(mm).T[0]));
    }
    CHECK(laminate(mirror.of_thickness(1), mirror.of_thickness(1)).R_top[0] == Approx(1).margin(1e-9));
}

TEST_CASE("Layers of different sizes cannot be stacked, nor be made of nothing known") {
    CHECK_THROWS_AS(laminate(no_layer(2), no_layer(3)), ContractViolation);
    CHECK_THROWS_AS(scalar(0.5, 0.5, 0), ContractViolation);
    CHECK_THROWS_AS(scalar(0.5, std::nan(""), 1), ContractViolation);
    CHECK_THROWS_AS(scalar(0.5, 0.5, 1).of_thickness(-1), ContractViolation);
}
