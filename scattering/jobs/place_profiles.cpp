// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/place_profiles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/parallel.h"

namespace voxtone::scattering {
namespace {

/// The light of a window by knot.
std::vector<double> by_knot(std::span<const double> window, std::span<const ProfileRing> rings, std::uint32_t radius,
                            double cell_mm2) {
    const std::size_t side = 2 * std::size_t{radius} + 1;
    std::vector<double> light(std::size_t{radius} + 1);
    for (const ProfileRing& ring : rings) {
        double sum = 0;
        for (const auto& [x, y] : ring.offsets)
            sum += window[static_cast<std::size_t>(y + static_cast<int>(radius)) * side +
                          static_cast<std::size_t>(x + static_cast<int>(radius))];
        light[ring.knot] += ring.low_share * sum * cell_mm2;
        light[ring.knot + 1] += (1 - ring.low_share) * sum * cell_mm2;
    }
    return light;
}

template <class Source>
std::vector<PlaceProfile> mean_of(const Source& source, std::span<const std::size_t> points, std::uint32_t radius,
                                  double pitch_mm) {
    const auto rings = profile_rings(radius);
    const std::vector<double> everywhere((2 * std::size_t{radius} + 1) * (2 * std::size_t{radius} + 1), 1.0);
    const std::vector<double> area = by_knot(everywhere, rings, radius, pitch_mm * pitch_mm);
    std::vector<PlaceProfile> profiles(source.channels.size());
    parallel_for(0, profiles.size(), 1, [&](std::size_t c) {
        PlaceProfile& profile = profiles[c];
        std::vector<double> window(everywhere.size());
        for (const std::size_t point : points) {
            const std::vector<double> response = response_at(source, c, point);
            for (std::size_t i = 0; i < window.size(); ++i)
                window[i] += response[i] / static_cast<double>(points.size());
        }
        profile.light = by_knot(window, rings, radius, pitch_mm * pitch_mm);
        for (std::size_t k = 0; k < area.size(); ++k) profile.per_mm2.push_back(profile.light[k] / area[k]);
    });
    return profiles;
}

}  // namespace

double PlaceProfile::total() const { return std::accumulate(light.begin(), light.end(), beyond); }

std::vector<double> PlaceProfile::coefficients(const optics::HankelGrid& grid, double pitch_mm) const {
    std::vector<double> edges{0}, rings = light;
    for (std::size_t k = 0; k < light.size(); ++k) edges.push_back((static_cast<double>(k) + 0.5) * pitch_mm);
    rings.push_back(beyond);
    edges.push_back(2 * edges.back());
    return grid.from_rings(edges, rings);
}

std::vector<PlaceProfile> place_profiles(const LocalProfiles& profiles, std::span<const std::size_t> points) {
    return mean_of(profiles, points, profiles.radius, profiles.pitch_mm);
}

std::vector<PlaceProfile> place_profiles(const optics::SampledBssrdf& responses, std::span<const std::size_t> points) {
    std::vector<PlaceProfile> profiles = mean_of(responses, points, responses.radius, responses.pitch_mm);
    for (std::size_t c = 0; c < profiles.size(); ++c) {
        double total = 0;
        for (const std::size_t point : points) total += static_cast<double>(responses.channels[c].total[point]);
        profiles[c].beyond = std::max(0.0, total / static_cast<double>(points.size()) - profiles[c].total());
    }
    return profiles;
}

double noise_of(const optics::SampledBssrdf& responses, const std::vector<PlaceProfile>& profiles, std::size_t points) {
    // A coefficient is a mean of J0, at most 1, over the light; a pair within the cluster counts at both of its ends.
    double variance = 0;
    for (std::size_t c = 0; c < profiles.size(); ++c)
        variance += 2 * responses.channels[c].noise * responses.cell_mm2() * profiles[c].total() /
                    static_cast<double>(points * profiles.size());
    return std::sqrt(variance);
}

std::vector<std::vector<std::size_t>> points_of_clusters(const io::ProfileMap& map, std::uint32_t margin) {
    std::vector<std::vector<std::size_t>> points(map.target.size());
    for (std::size_t y = margin; y + margin < map.height_px; ++y)
        for (std::size_t x = margin; x + margin < map.width_px; ++x)
            points[map.cluster[y * map.width_px + x]].push_back(y * map.width_px + x);
    return points;
}

namespace {

/// The light under straight lines between samples.
double light_of(const optics::RadialSamples& samples) {
    const double unit = 2 * std::numbers::pi * samples.spacing_mm * samples.spacing_mm;
    const std::size_t last = samples.light.size() - 1;
    double total = unit * samples.light[0] / 6;
    for (std::size_t k = 1; k <= last; ++k) {
        const double place = static_cast<double>(k);
        total += unit * samples.light[k] * (k < last ? place : place / 2 - 1.0 / 6);
    }
    return total;
}

double value_at(const optics::RadialSamples& samples, double r_mm) {
    const double at = std::min(r_mm / samples.spacing_mm, static_cast<double>(samples.light.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(at), samples.light.size() - 2);
    const double share = at - static_cast<double>(i);
    return std::max(0.0, samples.light[i] * (1 - share) + samples.light[i + 1] * share);
}

}  // namespace

std::vector<double> knots_of(const optics::RadialSamples& samples, std::uint32_t radius, double pitch_mm) {
    std::vector<double> P{0};
    for (std::uint32_t k = 1; k <= radius; ++k) P.push_back(value_at(samples, k * pitch_mm));
    const auto others = light_by_knot(P, profile_rings(radius), pitch_mm);
    const double left = light_of(samples) - std::accumulate(others.begin(), others.end(), 0.0);
    P[0] = std::max(P[1], left / (pitch_mm * pitch_mm));
    return P;
}

std::uint32_t radius_of_map(const io::ProfileMap& map) {
    const optics::RadialSamples& first = map.target.at(0).at(0);
    const double extent_mm = first.spacing_mm * static_cast<double>(first.light.size() - 1);
    return static_cast<std::uint32_t>(
        std::clamp(std::floor(extent_mm / (map.width_mm / map.width_px) + 1e-6), 1.0, 64.0));
}

LocalProfiles profiles_of_map(const io::ProfileMap& map) {
    LocalProfiles profiles{{map.width_px, map.height_px}, radius_of_map(map), map.width_mm / map.width_px, {}};
    const std::size_t points = profiles.grid.points();
    for (std::size_t c = 0; c < map.channels.size(); ++c) {
        ProfileImages& images = profiles.channels.emplace_back(profiles.knots() * points);
        std::vector<std::vector<double>> P;
        for (const auto& target : map.target) P.push_back(knots_of(target[c], profiles.radius, profiles.pitch_mm));
        for (std::size_t k = 0; k < profiles.knots(); ++k)
            for (std::size_t i = 0; i < points; ++i) images[k * points + i] = P[map.cluster[i]][k];
    }
    return profiles;
}

}  // namespace voxtone::scattering
