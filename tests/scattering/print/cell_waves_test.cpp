// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/cell_waves.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::scattering;

TEST_CASE("Of a wave so much is left by pixels as two places within a pixel each see of each other's") {
    // The distance of two places within squares has the density of two triangles.
    constexpr int steps = 200;
    for (const double k : {0.0, 0.3, 1.0, 1.7}) {
        double sum = 0, weights = 0;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const double x = (i + 0.5) / steps, y = (j + 0.5) / steps, weight = (1 - x) * (1 - y);
                sum += weight * std::cyl_bessel_j(0, 2 * std::numbers::pi * k * 0.5 * std::hypot(x, y));
                weights += weight;
            }
        CHECK(left_by_cells(k, 0.5) == Approx(sum / weights).margin(1e-4));
    }
    CHECK(left_by_cells(1, 0.5) < 0.5);
}

namespace {

// Mean over both cells of exp(-r / fall) / (2 pi fall^2), cells (x, y) apart: each coordinate's distance has the
// density of a triangle.
double mean_over_cells(double x, double y, double cell, double fall) {
    constexpr int steps = 120;
    double sum = 0, weights = 0;
    for (int i = -steps; i < steps; ++i)
        for (int j = -steps; j < steps; ++j) {
            const double u = (i + 0.5) / steps, v = (j + 0.5) / steps;
            const double weight = (1 - std::abs(u)) * (1 - std::abs(v));
            sum += weight * std::exp(-std::hypot(x + u, y + v) * cell / fall);
            weights += weight;
        }
    return sum / weights / (2 * std::numbers::pi * fall * fall);
}

}  // namespace

TEST_CASE("Waves of a point are found behind means over cells") {
    constexpr double cell = 0.5, fall = 0.4;
    const optics::HankelGrid grid(10, 20);
    std::vector<double> P;
    for (int k = 0; k <= 10; ++k) P.push_back(mean_over_cells(k, 0, cell, fall));
    const std::vector<double> found = waves_behind_cells(P, cell, grid);
    const std::vector<double> lines = grid.from_even(P, cell);
    for (std::size_t i = 0; i < grid.size() && grid.k()[i] < 0.62; ++i) {
        // Hankel transform of the exponential.
        const double truth = std::pow(1 + std::pow(2 * std::numbers::pi * grid.k()[i] * fall, 2), -1.5);
        CHECK(found[i] == Approx(truth).epsilon(0.03));
        // Straight lines between the samples would spread what is wanted.
        if (grid.k()[i] > 0.55) CHECK(lines[i] / left_by_cells(grid.k()[i], cell) < 0.88 * truth);
    }
}
