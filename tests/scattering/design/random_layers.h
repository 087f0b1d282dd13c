// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random materials that are physical: S > 0 falls or stays with frequency, K > 0 grows; and profiles to ask for.
#pragma once

#include <algorithm>

#include "resin_layers.h"

namespace voxtone {

inline std::vector<scattering::LaminateMaterial> random_materials(RandomStream& random, std::size_t materials,
                                                                  std::size_t channels, std::size_t coefficients) {
    std::vector<scattering::LaminateMaterial> all(materials);
    for (scattering::LaminateMaterial& material : all)
        for (std::size_t c = 0; c < channels; ++c) {
            double K = log_uniform(random, 1e-3, 3), S = log_uniform(random, 0.1, 10);
            std::vector<FrequencyMedium> media;
            for (std::size_t i = 0; i < coefficients; ++i) {
                media.push_back({K, S});
                K *= 1 + 0.6 * random.uniform();
                S *= 1 - 0.1 * random.uniform();
            }
            material.push_back(layer_of(media));
        }
    return all;
}

/// Falls with frequency, by a random total and width.
inline scattering::ChannelProfiles random_target(RandomStream& random, std::size_t channels, std::size_t coefficients) {
    scattering::ChannelProfiles target(channels);
    for (std::vector<double>& channel : target) {
        double R = 0.02 + 0.93 * random.uniform();
        const double fall = 0.4 * random.uniform();
        for (std::size_t i = 0; i < coefficients; ++i) {
            channel.push_back(R);
            R *= 1 - fall * random.uniform();
        }
    }
    return target;
}

inline scattering::ChannelProfiles disturbed(RandomStream& random, scattering::ChannelProfiles profiles, double by) {
    for (std::vector<double>& channel : profiles)
        for (double& x : channel) x += by * (2 * random.uniform() - 1);
    return profiles;
}

}  // namespace voxtone
