// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/area_samples.h"

#include <cmath>

#include <catch2/catch.hpp>

using namespace voxtone::slicer;

TEST_CASE("Samples by area fall on triangles by their share of it, evenly within each") {
    // Areas 1/2, 3/2, none and 2.
    VisibleSurface surface;
    surface.positions_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 0, 0}, {0, 0, 4}};
    surface.triangles = {{0, 1, 2}, {0, 3, 2}, {0, 1, 1}, {0, 1, 4}};
    const AreaSamples samples(surface);
    CHECK(samples.area_mm2() == 4);
    CHECK(samples.area_mm2() == coloured_area_mm2(surface));

    constexpr int n = 20000;
    double hits[4] = {}, u = 0, v = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
        const AreaSamples::Sample s = samples.at(7, i);
        REQUIRE((s.triangle < 4 && s.u >= 0 && s.v >= 0 && s.u + s.v <= 1));
        hits[s.triangle] += 1;
        u += s.u;
        v += s.v;
    }
    const double share[4] = {0.125, 0.375, 0, 0.5};
    for (int t = 0; t < 4; ++t) CHECK(std::abs(hits[t] / n - share[t]) <= 5 * std::sqrt(share[t] * (1 - share[t]) / n));
    // The mean of a triangle is its centre; the variance of u is 1/18.
    CHECK(std::abs(u / n - 1.0 / 3) < 5 * std::sqrt(1.0 / 18 / n));
    CHECK(std::abs(v / n - 1.0 / 3) < 5 * std::sqrt(1.0 / 18 / n));

    const AreaSamples::Sample again = samples.at(7, 11), other = samples.at(8, 11);
    CHECK(again.u == samples.at(7, 11).u);
    CHECK(again.u != other.u);
}
