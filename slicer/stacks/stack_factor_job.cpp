// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/stacks/stack_factor_job.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"
#include "slicer/stacks/profile_map_picture.h"

namespace voxtone::slicer {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Of the light, beyond which a window is said to be too small.
constexpr double most_beyond_window = 0.05;

/// "red", "550 nm" or "channel 2".
std::string colour_name(const optics::Channels& channels, std::size_t c) {
    static constexpr const char* rgb[] = {"red", "green", "blue"};
    return channels.is_rgb() ? std::string(rgb[c]) : channel_name(channels, c);
}

std::optional<std::size_t> drawn_point(const StackFactorJob& job, const optics::SampledBssrdf& responses) {
    if (!job.point) return std::nullopt;
    const auto [x, y] = *job.point;
    if (x >= responses.width || y >= responses.height)
        throw UsageError(fmt::format("--point {},{} lies outside of {}, which has {} x {} points, counted from 0.", x,
                                     y, job.dataset, responses.width, responses.height));
    return std::size_t{y} * responses.width + x;
}

void warn_of(const ChannelOutcome& outcome, const std::string& channel, const optics::SampledBssrdf& responses,
             Progress& progress) {
    if (!outcome.factor.converged)
        progress.warn(
            fmt::format("{}: the factorisation stopped at a residual of {:.1e} after {} steps; give it more --steps or "
                        "a larger --tolerance",
                        channel, outcome.factor.residual, outcome.factor.steps));
    if (outcome.beyond_window > most_beyond_window)
        progress.warn(
            fmt::format("{}: {:.1f} % of the light left beyond the window of {:.3g} mm, where the profiles end: they "
                        "are too dark by that; use data of a larger window",
                        channel, 100 * outcome.beyond_window, responses.radius * responses.pitch_mm));
}

std::string channel_text(const ChannelOutcome& outcome, const std::string& channel) {
    const auto& [factor, factored, clustered, factored_checked, clustered_checked, beyond] = outcome;
    return fmt::format(
        "  {}: {} steps, {} iterations, residual {:.1e}; light in the wrong place {:.1f} % factored, {:.1f} % "
        "clustered (noise alone {:.1f} %); light kept {:.4f}, {:.4f}; albedo +-{:.4f}, +-{:.4f}; {:.1f} % of the light "
        "left beyond the window\n",
        channel, factor.steps, factor.iterations, factor.residual, 100 * factored.light_error,
        100 * clustered.light_error, 100 * factored.noise_error, factored.light, clustered.light, factored.albedo_error,
        clustered.albedo_error, 100 * beyond);
}

std::string check_text(const ChannelOutcome& outcome, const std::string& file) {
    const halftone::ReconstructionError &factored = outcome.factored_checked, &clustered = outcome.clustered_checked;
    return fmt::format(
        "    against {}: {:.1f} %, {:.1f} % in the wrong place (noise alone {:.1f} %); beyond noise {:.1f} %, {:.1f} "
        "%; albedo +-{:.4f}, +-{:.4f}\n",
        file, 100 * factored.light_error, 100 * clustered.light_error, 100 * factored.noise_error,
        100 * factored.excess, 100 * clustered.excess, factored.albedo_error, clustered.albedo_error);
}

Json error_json(const halftone::ReconstructionError& error) {
    return {{"light_error", error.light_error},
            {"noise_error", error.noise_error},
            {"excess", error.excess},
            {"light", error.light},
            {"albedo_error", error.albedo_error},
            {"largest_albedo_error", error.largest_albedo_error}};
}

Json channel_json(const ChannelOutcome& outcome, bool checked) {
    Json json{{"steps", outcome.factor.steps},
              {"iterations", outcome.factor.iterations},
              {"residual", outcome.factor.residual},
              {"converged", outcome.factor.converged},
              {"factored", error_json(outcome.factored)},
              {"clustered", error_json(outcome.clustered)},
              {"beyond_window", outcome.beyond_window}};
    if (checked) {
        json["factored_checked"] = error_json(outcome.factored_checked);
        json["clustered_checked"] = error_json(outcome.clustered_checked);
    }
    return json;
}

Json clusters_json(const ProfileMapResult& result, std::size_t points) {
    Json json = Json::array();
    for (const halftone::ProfileCluster& cluster : result.clusters.clusters)
        json.push_back({{"points", cluster.points},
                        {"share", cluster.points / static_cast<double>(points)},
                        {"distance", cluster.distance}});
    return json;
}

std::string result_json(const StackFactorJob& job, const io::BssrdfFile& data, const ProfileMapResult& result) {
    Json channels = Json::array();
    for (const ChannelOutcome& outcome : result.channels) channels.push_back(channel_json(outcome, !job.check.empty()));
    const Json json{{"format", "voxtone-stack-factor"},
                    {"version", 1},
                    {"map", job.out},
                    {"points", {data.responses.width, data.responses.height}},
                    {"factor_seconds", result.factor_seconds},
                    {"cluster_seconds", result.cluster_seconds},
                    {"channels", channels},
                    {"rounds", result.clusters.rounds},
                    {"distance", result.clusters.distance},
                    {"clusters", clusters_json(result, data.responses.points())},
                    {"brightest_albedo", result.brightest},
                    {"scale", result.scale}};
    return json.dump();
}

std::string result_text(const StackFactorJob& job, const io::BssrdfFile& data, const ProfileMapResult& result) {
    std::string text = fmt::format(
        "{}: {} x {} points, factored in {:.1f} s, {} clusters in {:.1f} s ({} rounds, distance {:.4f})\n", job.out,
        data.responses.width, data.responses.height, result.factor_seconds, result.clusters.clusters.size(),
        result.cluster_seconds, result.clusters.rounds, result.clusters.distance);
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
        text += channel_text(result.channels[c], colour_name(data.channels, c));
        if (!job.check.empty()) text += check_text(result.channels[c], job.check);
    }
    return text + fmt::format("  brightest profile {:.4f}, scaled by {:.4f}\n", result.brightest, result.scale);
}

/// Draws the comparison and says what its colours mean.
std::string draw(const StackFactorJob& job, const io::BssrdfFile& data, const ProfileMapResult& result,
                 std::optional<std::size_t> point) {
    const ComparisonPicture drawn = draw_comparison(data, result, point);
    io::write_whole_file(job.picture, io::png_bytes(drawn.picture));
    return fmt::format(
        "  {}: albedo; mean distance {:.2f} to {:.2f} mm ({}); response of point ({}, {}), {:.2g} to {:.2g} per mm2; "
        "data, factored, clustered\n",
        job.picture, drawn.least_mm, drawn.most_mm, colour_name(data.channels, drawn.channel),
        drawn.point % data.responses.width, drawn.point / data.responses.width, drawn.least_per_mm2,
        drawn.most_per_mm2);
}

std::vector<fs::path> outputs(const StackFactorJob& job) {
    std::vector<fs::path> files{job.out, io::profile_map_picture(job.out)};
    if (!job.picture.empty()) files.emplace_back(job.picture);
    return files;
}

}  // namespace

void StackFactorJob::validate() const {
    map.validate();
    if (!out.ends_with(".json")) throw UsageError(fmt::format("{}: the name of a profile map ends in .json", out));
}

JobResult run_stack_factor(const StackFactorJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs(outputs(job), job.overwrite);
    const io::BssrdfFile data = io::read_bssrdf(job.dataset);
    const std::optional<std::size_t> point = drawn_point(job, data.responses);
    const io::BssrdfFile check = job.check.empty() ? io::BssrdfFile() : io::read_bssrdf(job.check);
    const ProfileMapResult result = make_profile_map(data, job.map, progress, job.check.empty() ? nullptr : &check);
    io::write_profile_map(result.map, job.out);
    for (std::size_t c = 0; c < result.channels.size(); ++c)
        warn_of(result.channels[c], colour_name(data.channels, c), data.responses, progress);
    std::string text = result_text(job, data, result);
    if (!job.picture.empty()) text += draw(job, data, result, point);
    return {result_json(job, data, result), text};
}

}  // namespace voxtone::slicer
