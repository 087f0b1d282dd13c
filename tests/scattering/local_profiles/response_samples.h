// SPDX-License-Identifier: GPL-3.0-or-later
//
// Responses of known local profiles, with and without the noise of counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/random.h"
#include "scattering/local_profiles/local_profiles.h"
#include "scattering/local_profiles/profile_reconstruction.h"

namespace voxtone::scattering::testing {

/// exp(-r / width) with a width of 0.7 to 2.1 points and a height within a factor of 3 that wander over the grid,
/// differently by channel; steeper at the entry, so that second differences are not 0.
inline LocalProfiles wandering_profiles(PointGrid grid, std::uint32_t radius, std::size_t channels) {
    LocalProfiles profiles{grid, radius, 0.5, {}};
    for (std::size_t c = 0; c < channels; ++c) {
        ProfileImages P(profiles.knots() * grid.points());
        for (std::size_t i = 0; i < grid.points(); ++i) {
            const double x = static_cast<double>(i % grid.width), y = static_cast<double>(i / grid.width),
                         phase = static_cast<double>(c);
            const double wave = 0.5 + 0.5 * std::sin(0.21 * x + 0.13 * y + phase),
                         other = 0.5 + 0.5 * std::cos(0.09 * x - 0.17 * y + 2 * phase);
            const double width = 0.7 * std::pow(3.0, wave), height = std::pow(3.0, -other);
            for (std::size_t k = 0; k < profiles.knots(); ++k) {
                const double r = static_cast<double>(k);
                P[k * grid.points() + i] = height * std::exp(-r / width - 0.5 * r / (r + 1));
            }
        }
        profiles.channels.push_back(std::move(P));
    }
    return profiles;
}

/// A count of Poisson's distribution: by products for small means, by the nearest whole of a normal one above 30.
inline double poisson(RandomStream& random, double mean) {
    if (mean > 30) {
        const double u = 1 - random.uniform(), v = random.uniform();
        return std::max(
            0.0, std::round(mean + std::sqrt(mean) * std::sqrt(-2 * std::log(u)) * std::cos(6.283185307179586 * v)));
    }
    double product = random.uniform(), least = std::exp(-mean);
    int count = 0;
    for (; product > least; ++count) product *= random.uniform();
    return count;
}

/// Eq. 7; counts > 0: with the noise of that many counts where P is 1, else without noise.
inline optics::SampledBssrdf separable_responses(const LocalProfiles& profiles, double counts, std::uint64_t seed) {
    const PointGrid grid = profiles.grid;
    optics::SampledBssrdf responses{grid.width, grid.height, profiles.radius, profiles.pitch_mm, {}};
    const auto offsets = optics::half_window(profiles.radius);
    const auto rings = profile_rings(profiles.radius);
    const std::size_t points = grid.points();
    for (const ProfileImages& P : profiles.channels) {
        optics::ChannelResponses data;
        data.noise = counts > 0 ? 1 / counts : 0;
        data.total.assign(points, 1.0f);
        data.pairs.assign(points * offsets.size(), 0.0f);
        for (std::size_t s = 0; s < offsets.size(); ++s) {
            const auto ring = std::find_if(rings.begin(), rings.end(), [&](const ProfileRing& r) {
                return std::find(r.offsets.begin(), r.offsets.end(), offsets[s]) != r.offsets.end();
            });
            const double noise = s == 0 ? 2 * data.noise : data.noise;
            for (std::size_t i = 0; i < points; ++i) {
                const int x = static_cast<int>(i % grid.width) + offsets[s].x,
                          y = static_cast<int>(i / grid.width) + offsets[s].y;
                if (x < 0 || y < 0 || x >= static_cast<int>(grid.width) || y >= static_cast<int>(grid.height)) continue;
                const auto o = static_cast<std::size_t>(y) * grid.width + static_cast<std::size_t>(x);
                const auto log_at = [&](std::size_t k) {
                    return 0.5 * std::log(P[k * points + i] * P[k * points + o]);
                };
                double R =
                    std::exp(ring->low_share * log_at(ring->knot) + (1 - ring->low_share) * log_at(ring->knot + 1));
                if (counts > 0) {
                    RandomStream random(seed, s * points + i, static_cast<std::uint32_t>(responses.channels.size()));
                    R = noise * poisson(random, R / noise);
                }
                data.pairs[s * points + i] = static_cast<float>(R);
            }
        }
        responses.channels.push_back(std::move(data));
    }
    return responses;
}

/// Light by knot that differs / light, over all points of a channel.
inline double profile_error(const LocalProfiles& truth, const LocalProfiles& found, std::size_t channel) {
    const std::size_t points = truth.grid.points();
    const auto rings = profile_rings(truth.radius);
    double difference = 0, light = 0;
    std::vector<double> a(truth.knots()), b(truth.knots());
    for (std::size_t i = 0; i < points; ++i) {
        for (std::size_t k = 0; k < truth.knots(); ++k) {
            a[k] = truth.channels[channel][k * points + i];
            b[k] = found.channels[channel][k * points + i];
        }
        const auto of_a = light_by_knot(a, rings, truth.pitch_mm), of_b = light_by_knot(b, rings, truth.pitch_mm);
        for (std::size_t k = 0; k < of_a.size(); ++k) {
            difference += std::abs(of_a[k] - of_b[k]);
            light += of_a[k];
        }
    }
    return difference / light;
}

}  // namespace voxtone::scattering::testing
