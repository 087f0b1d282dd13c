// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/profile_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "scattering/local_profiles/profile_reconstruction.h"

namespace voxtone::scattering {
namespace {

constexpr std::size_t points_per_task = 1024;

/// Roots of light: rows of `size` numbers, one per point.
struct Features {
    std::size_t size = 0;
    std::vector<float> values;
    [[nodiscard]] std::size_t points() const { return values.size() / size; }
    [[nodiscard]] const float* of(std::size_t point) const { return values.data() + point * size; }
};

Features features_of(const LocalProfiles& profiles) {
    const std::size_t knots = profiles.knots(), points = profiles.grid.points();
    const auto rings = profile_rings(profiles.radius);
    Features features{knots * profiles.channels.size(), {}};
    features.values.resize(features.size * points);
    parallel_for(0, points, points_per_task, [&](std::size_t i) {
        float* to = features.values.data() + i * features.size;
        std::vector<double> P(knots);
        for (const ProfileImages& images : profiles.channels) {
            for (std::size_t k = 0; k < knots; ++k) P[k] = images[k * points + i];
            for (const double light : light_by_knot(P, rings, profiles.pitch_mm))
                *to++ = static_cast<float>(std::sqrt(light));
        }
    });
    return features;
}

double squared_distance(const float* a, const float* b, std::size_t size) {
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += d * d;
    }
    return sum;
}

using Centres = std::vector<std::vector<float>>;

/// Points drawn one after the other with a chance that grows with the squared distance to those that there are.
Centres first_centres(const Features& features, const ClusterOptions& options) {
    const std::size_t points = features.points();
    Centres centres;
    std::vector<double> nearest(points, 1.0);
    while (centres.size() < options.clusters) {
        const double all = std::accumulate(nearest.begin(), nearest.end(), 0.0);
        if (!(all > 0)) break;  // no other profiles left
        double left = RandomStream(options.seed, centres.size(), 21).uniform() * all;
        std::size_t chosen = points;
        for (std::size_t i = 0; i < points; ++i) {
            if (nearest[i] > 0) chosen = i;
            left -= nearest[i];
            if (left < 0 && nearest[i] > 0) break;
        }
        centres.emplace_back(features.of(chosen), features.of(chosen) + features.size);
        const bool first = centres.size() == 1;
        parallel_for(0, points, points_per_task, [&](std::size_t i) {
            const double d = squared_distance(features.of(i), centres.back().data(), features.size);
            nearest[i] = first ? d : std::min(nearest[i], d);
        });
    }
    return centres;
}

struct Assignment {
    std::vector<std::uint16_t> cluster;
    std::vector<float> squares;  ///< of the distance to it
};

/// The nearest centre of each point, the first of several.
void assign(const Features& features, const Centres& centres, Assignment& to) {
    const std::size_t n = centres.size(), size = features.size;
    std::vector<float> by_number(n * size);  // all centres side by side
    for (std::size_t c = 0; c < n; ++c)
        for (std::size_t j = 0; j < size; ++j) by_number[j * n + c] = centres[c][j];
    parallel_ranges(0, features.points(), points_per_task, [&](std::size_t first, std::size_t last) {
        std::vector<float> squares(n);
        for (std::size_t i = first; i < last; ++i) {
            std::fill(squares.begin(), squares.end(), 0.0f);
            for (std::size_t j = 0; j < size; ++j) {
                const float value = features.of(i)[j];
                const float* row = by_number.data() + j * n;
                for (std::size_t c = 0; c < n; ++c) squares[c] += (value - row[c]) * (value - row[c]);
            }
            const auto nearest = std::min_element(squares.begin(), squares.end());
            to.cluster[i] = static_cast<std::uint16_t>(nearest - squares.begin());
            to.squares[i] = *nearest;
        }
    });
}

/// A cluster that nobody belongs to takes the point that is farthest from its own.
void fill_empty(Assignment& assignment, std::size_t clusters) {
    std::vector<std::size_t> members(clusters);
    for (const auto c : assignment.cluster) ++members[c];
    for (std::size_t c = 0; c < clusters; ++c) {
        if (members[c] > 0) continue;
        std::size_t farthest = assignment.cluster.size();
        for (std::size_t i = 0; i < assignment.cluster.size(); ++i)
            if (members[assignment.cluster[i]] > 1 &&
                (farthest == assignment.cluster.size() || assignment.squares[i] > assignment.squares[farthest]))
                farthest = i;
        --members[assignment.cluster[farthest]];
        assignment.cluster[farthest] = static_cast<std::uint16_t>(c);
        assignment.squares[farthest] = 0;
        members[c] = 1;
    }
}

/// Means of the members, summed up in the order of the points.
void move_centres(const Features& features, const Assignment& assignment, Centres& centres) {
    std::vector<std::vector<double>> sums(centres.size(), std::vector<double>(features.size));
    std::vector<double> members(centres.size());
    for (std::size_t i = 0; i < features.points(); ++i) {
        auto& sum = sums[assignment.cluster[i]];
        for (std::size_t j = 0; j < features.size; ++j) sum[j] += static_cast<double>(features.of(i)[j]);
        ++members[assignment.cluster[i]];
    }
    for (std::size_t c = 0; c < centres.size(); ++c)
        for (std::size_t j = 0; j < features.size; ++j) centres[c][j] = static_cast<float>(sums[c][j] / members[c]);
}

}  // namespace

void ClusterOptions::validate() const {
    if (clusters < 1 || clusters > 65535)
        throw InputError(fmt::format("{} clusters are asked for, expected 1 to 65535.", clusters));
    if (!(tolerance >= 0 && tolerance < 1))
        throw InputError(fmt::format("The tolerance of clustering is {}, expected 0 to 1.", tolerance));
    if (max_rounds < 1)
        throw InputError(fmt::format("{} rounds of clustering are allowed, expected at least one.", max_rounds));
}

ProfileClusters cluster_profiles(const LocalProfiles& profiles, const ClusterOptions& options,
                                 const Progress* progress) {
    options.validate();
    const Features features = features_of(profiles);
    const std::size_t points = features.points(), knots = profiles.knots();
    Centres centres = first_centres(features, options);
    Assignment now{std::vector<std::uint16_t>(points), std::vector<float>(points)};
    double before = 0;
    ProfileClusters result;
    while (result.rounds < options.max_rounds && !result.converged) {
        if (progress) progress->check_cancelled();
        assign(features, centres, now);
        fill_empty(now, centres.size());
        const double squares = std::accumulate(now.squares.begin(), now.squares.end(), 0.0);
        result.converged = result.rounds > 0 && before - squares <= options.tolerance * before;
        before = squares;
        move_centres(features, now, centres);
        ++result.rounds;
    }

    result.clusters.resize(centres.size());
    for (ProfileCluster& cluster : result.clusters)
        cluster.P.assign(profiles.channels.size(), std::vector<double>(knots));
    for (std::size_t i = 0; i < points; ++i) {
        ProfileCluster& cluster = result.clusters[now.cluster[i]];
        ++cluster.points;
        const double squares = squared_distance(features.of(i), centres[now.cluster[i]].data(), features.size);
        cluster.distance += squares;
        result.distance += squares;
        for (std::size_t c = 0; c < profiles.channels.size(); ++c)
            for (std::size_t k = 0; k < knots; ++k) cluster.P[c][k] += std::sqrt(profiles.channels[c][k * points + i]);
    }
    for (ProfileCluster& cluster : result.clusters) {
        cluster.distance = std::sqrt(cluster.distance / cluster.points);
        for (auto& P : cluster.P)
            for (double& light : P) light = light / cluster.points * (light / cluster.points);
    }
    result.distance = std::sqrt(result.distance / static_cast<double>(points));
    result.cluster = std::move(now.cluster);
    return result;
}

LocalProfiles clustered(const LocalProfiles& profiles, const ProfileClusters& clusters) {
    LocalProfiles result = profiles;
    const std::size_t points = profiles.grid.points();
    for (std::size_t c = 0; c < profiles.channels.size(); ++c)
        for (std::size_t k = 0; k < profiles.knots(); ++k)
            for (std::size_t i = 0; i < points; ++i)
                result.channels[c][k * points + i] = clusters.clusters[clusters.cluster[i]].P[c][k];
    return result;
}

}  // namespace voxtone::scattering
