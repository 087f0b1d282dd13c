// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slabs that are traced, factored, and known otherwise.
#include <cmath>
#include <numeric>

#include <catch2/catch.hpp>

#include "optics/media/slab_patterns.h"
#include "optics/monte_carlo/layer_paths.h"
#include "scattering/local_profiles/profile_clusters.h"
#include "scattering/local_profiles/profile_reconstruction.h"

using namespace voxtone;
using namespace voxtone::scattering;

namespace {

struct Moments {
    double light = 0, distance = 0;
};

/// Light within the window and the mean distance it goes, in points, of P by knot.
Moments moments_of(std::span<const double> P, std::uint32_t radius, double pitch_mm) {
    Moments m;
    for (const ProfileRing& ring : profile_rings(radius)) {
        const double light = static_cast<double>(ring.offsets.size()) * pitch_mm * pitch_mm *
                             std::pow(P[ring.knot], ring.low_share) * std::pow(P[ring.knot + 1], 1 - ring.low_share);
        m.light += light;
        m.distance += light * ring.radius;
    }
    m.distance /= m.light;
    return m;
}

}  // namespace

TEST_CASE("A homogeneous slab has one profile everywhere, and it is that of its layer") {
    const optics::SampledBssrdfOptions options{
        .width = 28, .height = 24, .margin = 30, .radius = 6, .paths = 1500, .seed = 11};
    optics::ResinSet set;
    set.channels.wavelengths_nm = {550};
    set.eta = 1;
    set.resins = {{"one", "W", {6}, {0.99}}};
    const optics::ResinVolume volume =
        optics::make_resin_volume({88, 84, 6}, {0.3, 0.3, 0.25}, [](int, int, int) { return 1; });
    const auto data = optics::trace_bssrdf({&volume, &set, optics::Backing::black, optics::Sides::mirrored}, options);
    std::vector<FactorSummary> summary;
    const LocalProfiles found = factor_responses(data, {}, summary);

    // One cluster of all against the layer, endless and traced path by path. Of 1e6 paths both know the light to 0.001;
    // straight lines between knots and cells for points cost the rest.
    ClusterOptions one;
    one.clusters = 1;
    const auto all = cluster_profiles(found, one);
    const Moments mean = moments_of(all.clusters[0].P[0], 6, 0.3);
    const auto layer = optics::trace_layers({{{set.resins[0].medium(0), 1.5}}, set.g, 1, 1}, optics::HankelGrid(4, 64),
                                            {.paths = 1 << 19});
    double within = 0;
    for (std::size_t ring = 0; ring < layer.R.light.size(); ++ring)
        if (layer.edges_mm[ring + 1] <= 6.0 * 0.3) within += layer.R.light[ring];
    CHECK(mean.light == Approx(within).epsilon(0.01));
    double seen = 0;
    for (const float total : data.channels[0].total) seen += total / static_cast<double>(data.points());
    CHECK(seen == Approx(layer.R.total).epsilon(0.004));

    // Points differ by no more than their counts: of the light within the window each knows its own to sqrt(A / paths).
    double squares = 0, largest = 0;
    for (std::size_t i = 0; i < data.points(); ++i) {
        std::vector<double> P;
        for (std::size_t k = 0; k < 7; ++k) P.push_back(found.channels[0][k * data.points() + i]);
        const double difference = moments_of(P, 6, 0.3).light - mean.light;
        squares += difference * difference;
        largest = std::max(largest, std::abs(difference));
    }
    const double count_noise = std::sqrt(mean.light / options.paths);
    INFO("noise of counts " << count_noise << ", of points " << std::sqrt(squares / 672.0));
    CHECK(std::sqrt(squares / 672.0) < 2.5 * count_noise);
    CHECK(largest < 10 * count_noise);
}

TEST_CASE("Light stays what it is through factors and clusters of a slab of marble") {
    optics::ResinSet set = optics::vero_opaque();
    set.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    optics::SlabOptions slab_options;
    slab_options.width = slab_options.height = 24;
    const auto slab = optics::make_slab(set, slab_options);
    const optics::SampledBssrdfOptions options{
        .width = 24, .height = 24, .margin = 12, .radius = 5, .paths = 400, .seed = 1};
    const auto data =
        optics::trace_bssrdf({&slab.volume, &slab.mixtures, optics::Backing::black, optics::Sides::mirrored}, options);
    std::vector<FactorSummary> summary;
    const LocalProfiles found = factor_responses(data, {}, summary);
    ClusterOptions few;
    few.clusters = 20;
    const LocalProfiles means = clustered(found, cluster_profiles(found, few));
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(summary[c].converged);
        CHECK(reconstruction_error(data, c, found).light == Approx(1).epsilon(2e-4));
        CHECK(reconstruction_error(data, c, means).light == Approx(1).epsilon(5e-3));
        for (const double albedo : spread_of(means, c).albedo) CHECK((albedo > 0 && albedo < 1));
    }
}
