// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/profile_clusters.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "response_samples.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::scattering::testing;
using Catch::Matchers::Contains;

namespace {

/// Five kinds of profiles strewn over a grid, each value off by up to `spread` of itself.
LocalProfiles five_kinds(double spread, std::vector<int>& kind) {
    LocalProfiles profiles{{30, 20}, 4, 0.5, {ProfileImages(5 * 600), ProfileImages(5 * 600)}};
    for (std::size_t i = 0; i < 600; ++i) {
        RandomStream random(9, i);
        kind.push_back(static_cast<int>(5 * random.uniform()));
        const double width = 0.5 + 0.5 * kind.back();
        for (auto& P : profiles.channels)
            for (std::size_t k = 0; k < 5; ++k)
                P[k * 600 + i] = (1 + spread * (2 * random.uniform() - 1)) * std::exp(-static_cast<double>(k) / width);
    }
    return profiles;
}

}  // namespace

TEST_CASE("Groups of profiles that are alike are found") {
    std::vector<int> kind;
    const LocalProfiles profiles = five_kinds(0.05, kind);
    ClusterOptions options;
    options.clusters = 5;
    const ProfileClusters found = cluster_profiles(profiles, options);
    REQUIRE(found.clusters.size() == 5);
    CHECK(found.converged);
    std::map<int, std::set<int>> clusters_of_kind;
    for (std::size_t i = 0; i < 600; ++i) clusters_of_kind[kind[i]].insert(found.cluster[i]);
    std::set<int> all;
    for (const auto& [k, clusters] : clusters_of_kind) {
        CHECK(clusters.size() == 1);
        all.insert(*clusters.begin());
    }
    CHECK(all.size() == 5);
    std::uint32_t points = 0;
    for (const ProfileCluster& cluster : found.clusters) {
        points += cluster.points;
        CHECK(cluster.distance < 0.1);
    }
    CHECK(points == 600);
}

TEST_CASE("Clusters keep the light of their members") {
    std::vector<int> kind;
    const LocalProfiles profiles = five_kinds(0.4, kind);
    ClusterOptions options;
    options.clusters = 12;
    const ProfileClusters found = cluster_profiles(profiles, options);
    const LocalProfiles means = clustered(profiles, found);
    for (std::size_t c = 0; c < 2; ++c) {
        const auto before = spread_of(profiles, c).albedo, after = spread_of(means, c).albedo;
        const double light = std::accumulate(before.begin(), before.end(), 0.0);
        CHECK(std::accumulate(after.begin(), after.end(), 0.0) ==
              Approx(light).epsilon(5e-3));  // noise between knots: variance / 16, 0.3 %
    }
    options.clusters = 40;
    CHECK(cluster_profiles(profiles, options).distance < found.distance);
}

TEST_CASE("Where there are fewer profiles than clusters, each has its own") {
    std::vector<int> kind;
    const LocalProfiles profiles = five_kinds(0, kind);
    const ProfileClusters found = cluster_profiles(profiles, {});
    CHECK(found.clusters.size() == 5);
    CHECK(found.distance < 1e-6);
    for (const ProfileCluster& cluster : found.clusters) CHECK(cluster.points > 0);
}

TEST_CASE("No cluster is empty") {
    const LocalProfiles profiles = wandering_profiles({10, 10}, 3, 1);
    ClusterOptions options;
    for (const std::uint32_t clusters : {1u, 50u, 99u, 100u}) {
        options.clusters = clusters;
        const ProfileClusters found = cluster_profiles(profiles, options);
        for (const ProfileCluster& cluster : found.clusters) CHECK(cluster.points > 0);
        CHECK(found.clusters.size() <= clusters);
        CHECK(found.clusters.size() >= std::min(clusters, 50u));
    }
}

TEST_CASE("Clusters have the same bits for any number of threads, and follow from their seed") {
    const LocalProfiles profiles = wandering_profiles({70, 50}, 4, 2);
    ClusterOptions options;
    options.clusters = 17;
    std::vector<ProfileClusters> results;
    for (const std::size_t threads : {1u, 2u, 5u}) {
        const ThreadLimit limit(threads);
        results.push_back(cluster_profiles(profiles, options));
    }
    for (const ProfileClusters& other : results) {
        CHECK(other.cluster == results[0].cluster);
        CHECK(other.distance == results[0].distance);
        for (std::size_t k = 0; k < 17; ++k) CHECK(other.clusters[k].P == results[0].clusters[k].P);
    }
    options.seed = 2;
    CHECK(cluster_profiles(profiles, options).cluster != results[0].cluster);
}

TEST_CASE("Numbers of clusters out of range are refused") {
    const LocalProfiles profiles = wandering_profiles({3, 3}, 2, 1);
    ClusterOptions options;
    for (const std::uint32_t clusters : {0u, 65536u}) {
        options.clusters = clusters;
        CHECK_THROWS_WITH((void)cluster_profiles(profiles, options), Contains("clusters are asked for"));
    }
}
