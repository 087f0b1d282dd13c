// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/gaussian_profile.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

using namespace voxtone::optics;

namespace {

Waves transform(const GaussianWeights& weights) {
    Waves sum = Waves::Zero();
    for (std::size_t j = 0; j < weights.size(); ++j) {
        const auto half = static_cast<float>(0.5 * gaussian_widths_mm()[j]);
        sum += weights[j] * (-(half * wave_numbers()).square()).exp();
    }
    return sum;
}

float total(const GaussianWeights& weights) { return std::accumulate(weights.begin(), weights.end(), 0.0F); }

}  // namespace

TEST_CASE("Profiles of diffusing light are sums of a few Gaussians that hold all of their light") {
    // exp(-mu r) / (2 pi mu^-2): a cusp at r = 0 and a tail, P^ = (1 + (kappa / mu)^2)^(-3/2).
    for (const float mu : {1.0F, 3.0F, 10.0F})
        for (const float light : {0.02F, 0.9F}) {
            const Waves profile = light * (1 + (wave_numbers() / mu).square()).pow(-1.5F);
            const GaussianWeights weights = gaussian_weights(profile);
            INFO(mu << " " << light);
            CHECK(total(weights) == Approx(light).epsilon(1e-6));
            for (const float w : weights) CHECK(w >= 0);
            CHECK((transform(weights) - profile).abs().maxCoeff() < 0.015F * light);
        }
    for (const float w : gaussian_weights(Waves::Zero())) CHECK(w == 0);
}

TEST_CASE(
    "Of two profiles that differ in brightness the weights differ in that alone, and wider ones have wider Gaussians") {
    const auto profile = [](float mu) -> Waves { return (1 + (wave_numbers() / mu).square()).pow(-1.5F); };
    const GaussianWeights bright = gaussian_weights(profile(2)), dark = gaussian_weights(0.1F * profile(2)),
                          wide = gaussian_weights(profile(1));
    double mean_bright = 0, mean_wide = 0;
    for (std::size_t j = 0; j < bright.size(); ++j) {
        CHECK(dark[j] == Approx(0.1F * bright[j]).margin(1e-6));
        mean_bright += static_cast<double>(bright[j]) * gaussian_widths_mm()[j];
        mean_wide += static_cast<double>(wide[j]) * gaussian_widths_mm()[j];
    }
    CHECK(mean_wide / mean_bright == Approx(2).epsilon(0.1));
}
