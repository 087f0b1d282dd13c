// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/layered_appearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/layered/directional.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

double half_space_appearance(const OrdinatePlan& plan, double albedo) {
    return appearance(plan, half_space(plan, {1 - albedo, albedo}));
}

}  // namespace

TEST_CASE("The appearance of half-spaces agrees with Monte Carlo") {
    // A prototype of this project: 1.6 million paths each, diffuse light, g = 0.4, eta = 1.5; four digits. A path
    // returns a share between 0 and 1, so the variance of the mean is at most A (1 - A) / 1.6e6.
    const std::vector<std::pair<double, double>> measured{
        {0.35, 0.0124}, {0.5, 0.0237},   {0.7, 0.0553},   {0.9, 0.1675},   {0.95, 0.2648},  {0.98, 0.4097},
        {0.99, 0.5194}, {0.995, 0.6204}, {0.997, 0.6863}, {0.999, 0.7997}, {0.9997, 0.8827}};
    const OrdinatePlan plan = appearance_plan(0.4, 1.5);
    double chi_squared = 0, chi_squared_if_brighter = 0;
    for (const auto& [albedo, value] : measured) {
        const double variance = value * (1 - value) / 1.6e6 + 1e-8 / 12;  // of the estimate and of its rounding
        const double ours = half_space_appearance(plan, albedo);
        chi_squared += (ours - value) * (ours - value) / variance;
        chi_squared_if_brighter += (1.01 * ours - value) * (1.01 * ours - value) / variance;
    }
    // chi-squared of 11 degrees of freedom exceeds 31.3 once in a thousand; one percent too bright must be noticed.
    CHECK(chi_squared < 31.3);
    CHECK(chi_squared_if_brighter > 31.3);
}

TEST_CASE("Modes and adding-doubling solve the same equations") {
    const AngularGrid grid = angular_grid(1.5, 5, 5);
    const OrdinatePlan plan(grid, 0.4, 20);
    const AddingDoubling solver(grid, 0.4, 20);
    RandomStream random(7, 8);
    double worst = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const auto random_medium = [&] {
            const double sigma_t = 0.1 * std::pow(300, random.uniform()),
                         absorbed = std::pow(10, -5 * random.uniform());
            return Medium{sigma_t * absorbed, sigma_t * (1 - absorbed)};
        };
        const std::array<LayerOf, 2> layers{LayerOf{random_medium(), random.uniform()},
                                            LayerOf{random_medium(), random.uniform()}};
        const Medium base = random_medium();
        const LayerResponse upper = solver.layer(layers[0].medium, layers[0].thickness_mm);
        const LayerResponse lower = solver.layer(layers[1].medium, layers[1].thickness_mm);
        const auto compare = [&](double fast, double exact) { worst = std::max(worst, std::abs(fast - exact)); };
        compare(layered_appearance(plan, layers, half_space(plan, base)),
                appearance_of(grid, solver.over(upper, solver.over(lower, solver.half_space(base)))));
        const LayerResponse both = solver.add(upper, lower);
        compare(layered_appearance(plan, layers, Admittance::air(plan, true)),
                appearance_of(grid, both, Backing::none));
        compare(layered_appearance(plan, layers, Admittance::air(plan, false)),
                appearance_of(grid, both, Backing::black));
        compare(layered_appearance(plan, layers, Admittance::white_sheet(plan)),
                appearance_of(grid, both, Backing::white));
    }
    INFO(worst);
    CHECK(worst < 1e-8);
}

TEST_CASE("White furnace: what absorbs nothing looks exactly white") {
    const OrdinatePlan plan = appearance_plan(0.4, 1.5);
    CHECK(half_space_appearance(plan, 1) == Approx(1).margin(1e-12));
    const std::vector<LayerOf> layers{{{0, 3}, 0.1}, {{0, 40}, 2}, {{0, 0}, 1}, {{0, 0.01}, 0.3}};
    CHECK(layered_appearance(plan, layers, half_space(plan, {0, 5})) == Approx(1).margin(1e-11));
    CHECK(layered_appearance(plan, layers, Admittance::air(plan, true)) == Approx(1).margin(1e-11));
    CHECK(layered_appearance(plan, layers, Admittance::white_sheet(plan)) == Approx(1).margin(1e-11));
    CHECK(layered_appearance(plan, layers, Admittance::air(plan, false)) < 1);
}

TEST_CASE("Layers of modes: sixteen are one, none is nothing, order matters") {
    const OrdinatePlan plan = appearance_plan(0.4, 1.5);
    const Medium medium{0.3, 5.7}, other{2, 0.5};
    const Admittance base = half_space(plan, {0.01, 20});
    const std::vector<LayerOf> sixteen(16, LayerOf{medium, 1.0 / 16}), one{{medium, 1.0}};
    CHECK(layered_appearance(plan, sixteen, base) == Approx(layered_appearance(plan, one, base)).epsilon(1e-10));
    const double bare = appearance(plan, base);
    for (const double thickness : {0.0, 1e-12, 1e-10, 1e-9}) {
        const LayerOf film{medium, thickness};
        CHECK(layered_appearance(plan, std::span(&film, 1), base) == Approx(bare).margin(1e-8));
    }
    const LayerOf deep{{0.01, 20}, 1000};
    CHECK(layered_appearance(plan, std::span(&deep, 1), Admittance::black(plan)) == Approx(bare).epsilon(1e-10));
    const std::vector<LayerOf> dark_on_top{{other, 0.2}, {medium, 0.2}}, dark_below{{medium, 0.2}, {other, 0.2}};
    CHECK(layered_appearance(plan, dark_on_top, base) < 0.8 * layered_appearance(plan, dark_below, base));
}

TEST_CASE("Few directions suffice for appearance") {
    const OrdinatePlan few = appearance_plan(0.4, 1.5), many = appearance_plan(0.4, 1.5, 16, 16);
    double worst = 0;
    for (const double albedo : {0.0, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999}) {
        for (const double tau : {0.01, 0.1, 0.3, 1.0, 3.0, 30.0}) {
            const LayerOf layer{{1 - albedo, albedo}, tau};
            const auto compare = [&](const Admittance& few_base, const Admittance& many_base) {
                worst = std::max(worst, std::abs(layered_appearance(few, std::span(&layer, 1), few_base) -
                                                 layered_appearance(many, std::span(&layer, 1), many_base)));
            };
            for (const double base : {0.35, 0.99, 0.9997}) {
                compare(half_space(few, {1 - base, base}), half_space(many, {1 - base, base}));
            }
            compare(Admittance::air(few, true), Admittance::air(many, true));
        }
    }
    INFO(worst);
    CHECK(worst < 3e-5);
}

TEST_CASE("The slowest mode of white resin is its diffusion length") {
    const OrdinatePlan plan = appearance_plan(0.4, 1.5);
    const Medium white = vero_opaque().resins[4].medium(1);
    const double reduced = white.sigma_s * (1 - 0.4);
    // Diffusion theory to first order in absorption: kappa^2 = 3 sigma_a (sigma_a + sigma_s'), 1 + O(sigma_a /
    // sigma_s').
    CHECK(LayerModes(plan, white).decay_per_mm()[0] ==
          Approx(std::sqrt(3 * white.sigma_a * (white.sigma_a + reduced))).epsilon(1e-3));
}
