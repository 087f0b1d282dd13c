// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/profile_map_job.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"

namespace voxtone::scattering {
namespace {

double brightest_albedo(const ProfileMapResult& result) {
    const auto rings = profile_rings(result.factored.radius);
    double brightest = 0;
    for (const ProfileCluster& cluster : result.clusters.clusters)
        for (const auto& P : cluster.P) {
            const auto light = light_by_knot(P, rings, result.factored.pitch_mm);
            brightest = std::max(brightest, std::accumulate(light.begin(), light.end(), 0.0));
        }
    return brightest;
}

void check_comparable(const io::BssrdfFile& data, const io::BssrdfFile& check) {
    const auto& [width, height, radius, pitch, channels] = data.responses;
    if (check.channels != data.channels || check.responses.width != width || check.responses.height != height ||
        check.responses.radius != radius || std::abs(check.responses.pitch_mm - pitch) > 1e-9 * pitch)
        throw InputError(fmt::format(
            "The data to check with have {} x {} points at {} mm, radius {}, {} channels; those that are checked have "
            "{} x {} at {} mm, radius {}, {} channels: both must be of one surface, measured alike.",
            check.responses.width, check.responses.height, check.responses.pitch_mm, check.responses.radius,
            check.channels.size(), width, height, pitch, radius, channels.size()));
}

std::vector<ChannelOutcome> outcomes(const optics::SampledBssrdf& responses, const optics::SampledBssrdf* check,
                                     const ProfileMapResult& result, const std::vector<FactorSummary>& summary,
                                     Progress& progress) {
    std::vector<ChannelOutcome> channels;
    progress.begin_stage("compare", responses.channels.size(), "channels");
    for (std::size_t c = 0; c < responses.channels.size(); ++c) {
        ChannelOutcome& outcome = channels.emplace_back();
        outcome.factor = summary[c];
        outcome.factored = reconstruction_error(responses, c, result.factored);
        outcome.clustered = reconstruction_error(responses, c, result.clustered);
        outcome.beyond_window = optics::share_beyond_window(responses, c);
        if (check) {
            outcome.factored_checked = reconstruction_error(*check, c, result.factored);
            outcome.clustered_checked = reconstruction_error(*check, c, result.clustered);
        }
        progress.advance();
    }
    progress.end_stage();
    return channels;
}

io::ProfileMap map_of(const io::BssrdfFile& data, const ProfileClusters& clusters, double scale) {
    const optics::SampledBssrdf& responses = data.responses;
    io::ProfileMap map;
    map.source = data.source;
    map.channels = data.channels;
    map.width_px = responses.width;
    map.height_px = responses.height;
    map.width_mm = responses.width * responses.pitch_mm;
    map.height_mm = responses.height * responses.pitch_mm;
    map.cluster = clusters.cluster;
    for (const ProfileCluster& cluster : clusters.clusters) {
        auto& target = map.target.emplace_back();
        for (const auto& P : cluster.P) {
            target.push_back(radial_samples(P, responses.radius, responses.pitch_mm));
            for (double& light : target.back().light) light *= scale;
        }
    }
    return map;
}

}  // namespace

void ProfileMapOptions::validate() const {
    factor.validate();
    clusters.validate();
    if (max_albedo && !(*max_albedo > 0 && *max_albedo <= 1))
        throw InputError(fmt::format(
            "The largest albedo is to be {}, expected a number above 0, up to 1; the paper takes 0.6.", *max_albedo));
}

ProfileMapResult make_profile_map(const io::BssrdfFile& data, const ProfileMapOptions& options, Progress& progress,
                                  const io::BssrdfFile* check) {
    options.validate();
    if (check) check_comparable(data, *check);
    const optics::SampledBssrdf& responses = data.responses;
    ProfileMapResult result;
    Stopwatch watch;
    std::vector<FactorSummary> summary;
    progress.begin_stage("factor", responses.channels.size(), "channels");
    result.factored = factor_responses(responses, options.factor, summary, &progress);
    progress.end_stage();
    result.factor_seconds = watch.lap();

    progress.begin_stage("cluster", 0);
    result.clusters = cluster_profiles(result.factored, options.clusters, &progress);
    progress.end_stage();
    result.clustered = clustered(result.factored, result.clusters);
    result.cluster_seconds = watch.lap();

    result.channels = outcomes(responses, check ? &check->responses : nullptr, result, summary, progress);
    result.brightest = brightest_albedo(result);
    if (options.max_albedo) result.scale = *options.max_albedo / result.brightest;
    result.map = map_of(data, result.clusters, result.scale);
    return result;
}

}  // namespace voxtone::scattering
