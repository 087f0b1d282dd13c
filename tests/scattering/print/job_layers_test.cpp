// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/job_layers.h"

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

TEST_CASE("By itself a map is traced where it is of few clusters and its profiles are no means over its pixels") {
    io::ProfileMap map;
    map.width_px = 10, map.width_mm = 5;
    map.target.assign(16, {{0.1, {1, 1, 1, 1}, {}}});
    slicer::LayeredOptions options;
    CHECK(traced_rounds(options, map) == 1);
    map.target[0][0].spacing_mm = 0.5;  // a pixel
    CHECK(traced_rounds(options, map) == 0);
    options.rounds = 2;
    CHECK(traced_rounds(options, map) == 2);
    options.rounds.reset();
    map.target.assign(17, {{0.1, {1, 1, 1, 1}, {}}});
    CHECK(traced_rounds(options, map) == 0);
    map.target.resize(3);
    options.materials = {{"W", "white.json"}};
    CHECK(traced_rounds(options, map) == 0);
}
