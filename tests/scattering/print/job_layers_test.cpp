// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/job_layers.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

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
