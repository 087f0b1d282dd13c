// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/bounded_interval.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "tests/calibration/patches/target_samples.h"

using namespace voxtone::calibration;

TEST_CASE("The interval of a bounded value ends at the bound and moves up with the estimate") {
    // Far from the bound it is the usual one.
    CHECK(interval_above_zero(5).low == Approx(4));
    CHECK(interval_above_zero(5).high == Approx(6));
    // Where the likelihood ratio does not know of the bound, it is the usual one upwards.
    CHECK(interval_above_zero(0).high == Approx(1).margin(1e-5));
    CHECK(interval_above_zero(1).high == Approx(2).margin(1e-5));
    // A truth of 0 is accepted up to the 68.27 % point of the normal distribution.
    CHECK(interval_above_zero(0.475).low == 0);
    CHECK(interval_above_zero(0.478).low > 0);
    double before = 0;
    for (double x = -3; x < 4; x += 0.05) {
        const Interval i = interval_above_zero(x);
        CHECK(i.low >= 0);
        CHECK(i.high > before);
        before = i.high;
    }
}

TEST_CASE("Truths lie within the interval of a bounded value in 68 % of cases, wherever they are", "[slow]") {
    for (const double truth : {0.0, 0.1, 0.4, 0.8, 1.5, 3.0}) {
        int inside = 0, cut = 0;
        const int count = 4000;
        for (int k = 0; k < count; ++k) {
            const double x = truth + testing::normal(5, static_cast<std::uint64_t>(k));
            const Interval i = interval_above_zero(x);
            inside += i.low <= truth && truth <= i.high;
            const double clamped = std::max(x, 0.0);  // what cutting off would give
            cut += std::max(clamped - 1, 0.0) <= truth && truth <= clamped + 1;
        }
        INFO(truth);
        CHECK(inside / 4000.0 == Approx(0.6827).margin(0.022));  // three standard errors
        if (truth < 0.5) CHECK(cut / 4000.0 > 0.75);
    }
}
