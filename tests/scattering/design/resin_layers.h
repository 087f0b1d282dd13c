// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layer profiles of resins, from K and S that diffusion suggests, without a measurement.
//
// Light of spatial frequency k (kappa = 2 pi k) that diffuses through a medium is lost to absorption and, with D
// kappa^2, to the dark parts beside: K(k) = 2 (sigma_a + kappa^2 / (3 (sigma_a + sigma_s'))), S = 3/4 sigma_s',
// sigma_s' = (1 - g) sigma_s. Coefficients of a disc of 10 mm: kappa_0 = 0, kappa_i = (i + 3/4) pi / 10 mm, the zeros
// of J_0 to within 1 %.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/random.h"
#include "optics/media/resins.h"
#include "scattering/design/laminate_search.h"

namespace voxtone {

inline constexpr double profile_reach_mm = 10;

inline double layer_frequency(std::size_t i) {
    return i == 0 ? 0 : (static_cast<double>(i) + 0.75) * std::numbers::pi / profile_reach_mm;
}

struct FrequencyMedium {
    double K, S;
};
inline FrequencyMedium frequency_medium(double sigma_a, double reduced_sigma_s, std::size_t i) {
    const double kappa = layer_frequency(i);
    return {2 * (sigma_a + kappa * kappa / (3 * (sigma_a + reduced_sigma_s))), 0.75 * reduced_sigma_s};
}

/// R and T of Kubelka and Munk at `mm`, scattering S > 0, absorption K > 0.
inline optics::HomogeneousLayer layer_of(const std::vector<FrequencyMedium>& media, double mm = 0.1) {
    std::vector<double> T, R;
    for (const auto& [K, S] : media) {
        const double alpha = 1 + K / S, beta = std::sqrt(alpha * alpha - 1), x = beta * S * mm;
        const double sum = alpha * std::sinh(x) + beta * std::cosh(x);
        R.push_back(std::sinh(x) / sum);
        T.push_back(beta / sum);
    }
    return {T, R, mm};
}

inline optics::HomogeneousLayer diffusing_layer(double sigma_a, double reduced_sigma_s, std::size_t coefficients) {
    std::vector<FrequencyMedium> media;
    for (std::size_t i = 0; i < coefficients; ++i) media.push_back(frequency_medium(sigma_a, reduced_sigma_s, i));
    return layer_of(media);
}

/// What a half-space reflects.
inline std::vector<double> diffusing_target(double sigma_a, double reduced_sigma_s, std::size_t coefficients) {
    std::vector<double> R;
    for (std::size_t i = 0; i < coefficients; ++i) {
        const auto [K, S] = frequency_medium(sigma_a, reduced_sigma_s, i);
        R.push_back(1 + K / S - std::sqrt(K / S * (K / S + 2)));
    }
    return R;
}

/// The first of: VeroWhite, VeroBlack, a support that is mostly clear (sigma_s 0.6, sigma_a 0.01 mm^-1), VeroCyan,
/// VeroMagenta, VeroYellow. One channel is green.
inline std::vector<scattering::LaminateMaterial> resin_layers(std::size_t materials, std::size_t channels,
                                                              std::size_t coefficients) {
    const optics::ResinSet set = optics::vero_opaque();
    std::vector<scattering::LaminateMaterial> layers;
    for (const char* role : {"W", "K", "", "C", "M", "Y"}) {
        if (layers.size() == materials) break;
        scattering::LaminateMaterial& material = layers.emplace_back();
        for (std::size_t c = 0; c < channels; ++c) {
            optics::Medium medium{0.01, 0.6};
            if (*role) medium = set.resins[static_cast<std::size_t>(set.find(role))].medium(channels == 1 ? 1 : c);
            material.push_back(diffusing_layer(medium.sigma_a, (1 - set.g) * medium.sigma_s, coefficients));
        }
    }
    return layers;
}

inline double log_uniform(RandomStream& random, double low, double high) {
    return low * std::pow(high / low, random.uniform());
}

}  // namespace voxtone
