// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/portable_math.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

using namespace voxtone;

TEST_CASE("cube roots are those of the library to 2e-14, of every size and sign", "[numerics]") {
    double worst = 0;
    // Steps of 1.00037 meet eight octaves at other mantissas each: the first guess repeats in each three.
    for (double x = 1e-299; x<1e299; x *= x> 1e-4 && x < 1e4 ? 1.00037 : 1.37)
        for (const double sign : {-1.0, 1.0})
            worst = std::max(worst, std::abs(portable::cbrt(sign * x) / std::cbrt(sign * x) - 1));
    CAPTURE(worst);
    CHECK(worst < 2e-14);
}

TEST_CASE("cube roots of what has none nearby are those of the library", "[numerics]") {
    using Limits = std::numeric_limits<double>;
    for (const double x : {0.0, -0.0, Limits::denorm_min(), Limits::min(), Limits::max(), Limits::infinity()})
        CHECK(std::bit_cast<std::uint64_t>(portable::cbrt(x)) == std::bit_cast<std::uint64_t>(std::cbrt(x)));
    CHECK(std::isnan(portable::cbrt(Limits::quiet_NaN())));
}

TEST_CASE("cube roots of floats are the nearest ones, but for one in ten thousand", "[numerics]") {
    int differ = 0;
    for (int i = 1; i <= 100'000; ++i) {
        const float x = 1e-5f * static_cast<float>(i);
        differ += portable::cbrt(x) != static_cast<float>(std::cbrt(static_cast<double>(x)));
    }
    CHECK(differ <= 10);
}
