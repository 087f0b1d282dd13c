// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/mixture_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/contracts.h"

namespace voxtone::calibration {

namespace {

using Shares = std::vector<double>;  // of the inks and, last, of the rest

// Rounded down, so that the inks never sum to more than the whole.
Shares printed_shares(Shares shares) {
    constexpr double parts = 10000, slack = 1e-6;  // 0.3 is 3000 parts
    shares.pop_back();
    for (double& share : shares) share = std::floor(share * parts + slack) / parts;
    return shares;
}

void add_ramps(std::vector<Shares>& samples, std::size_t resins, std::size_t steps) {
    for (std::size_t a = 0; a < resins; ++a)
        for (std::size_t b = a + 1; b < resins; ++b)
            for (std::size_t step = 1; step <= steps; ++step) {
                Shares shares(resins, 0.0);
                shares[a] = static_cast<double>(step) / static_cast<double>(steps + 1);
                shares[b] = 1 - shares[a];
                samples.push_back(printed_shares(std::move(shares)));
            }
}

// The root of x^(d+1) = x + 1.
double plastic_number(std::size_t d) {
    double x = 2;
    for (int i = 0; i < 60; ++i) x = std::pow(1 + x, 1 / static_cast<double>(d + 1));
    return x;
}

Shares spread_mixture(std::size_t index, std::size_t resins, double phi) {
    Shares shares(resins);
    double step = 1;
    for (double& share : shares) {
        step /= phi;
        double u = 0.5 + static_cast<double>(index) * step;
        u -= std::floor(u);
        const double logarithm = std::log(std::max(u, 1e-12));
        share = logarithm * logarithm;
    }
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) share /= sum;
    return printed_shares(std::move(shares));
}

}  // namespace

std::vector<Shares> mixture_samples(std::size_t inks, std::size_t count) {
    VOXTONE_EXPECT(inks > 0 && count > inks);
    const std::size_t resins = inks + 1, pairs = resins * inks / 2;
    constexpr std::size_t most_steps = 7;
    std::vector<Shares> samples{Shares(inks, 0.0)};
    for (std::size_t ink = 0; ink < inks; ++ink) {
        samples.emplace_back(inks, 0.0);
        samples.back()[ink] = 1;
    }
    add_ramps(samples, resins, std::min({most_steps, count / 4 / pairs, (count - samples.size()) / pairs}));
    const double phi = plastic_number(resins);
    for (std::size_t index = 1; samples.size() < count; ++index) samples.push_back(spread_mixture(index, resins, phi));
    return samples;
}

}  // namespace voxtone::calibration
