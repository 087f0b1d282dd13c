// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/bounded_interval.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtone::calibration {

namespace {

double normal_share(double below) { return 0.5 * std::erfc(-below / std::numbers::sqrt2); }

const double within_one = std::erf(1 / std::numbers::sqrt2);

// Estimates that are accepted for a true value mu < 1, from `first` (below 0) to `second`: equal likelihood ratios at
// both ends.
struct Accepted {
    double first, second;
};

Accepted accepted(double mu) {
    const auto first = [&](double second) {
        return second > 2 * mu ? second - second * second / (2 * mu) : 2 * mu - second;
    };
    double low = mu, high = mu + 2;
    for (int step = 0; step < 45; ++step) {
        const double second = 0.5 * (low + high);
        (normal_share(second - mu) - normal_share(first(second) - mu) < within_one ? low : high) = second;
    }
    return {first(low), low};
}

// The mu in (0, 1) at which a rising function is x.
template <class Function>
double solve(Function&& function, double x) {
    double low = 1e-6, high = 1;
    for (int step = 0; step < 30; ++step) {
        const double mu = 0.5 * (low + high);
        (function(mu) < x ? low : high) = mu;
    }
    return 0.5 * (low + high);
}

}  // namespace

Interval interval_above_zero(double x) {
    x = std::max(x, -3.0);
    Interval interval{std::max(x - 1, 0.0), x + 1};
    if (x < 0) interval.high = solve([](double mu) { return accepted(mu).first; }, x);
    if (x < 2) interval.low = solve([](double mu) { return accepted(mu).second; }, x);
    if (interval.low < 2e-6) interval.low = 0;
    return interval;
}

}  // namespace voxtone::calibration
