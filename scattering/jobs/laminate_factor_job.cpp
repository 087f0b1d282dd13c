// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_factor_job.h"

#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture.h"
#include "scattering/jobs/profile_map_picture.h"
#include "scattering/local_profiles/luminance_channel.h"
#include "scattering/local_profiles/tinted_responses.h"

namespace voxtone::scattering {
namespace {

namespace fs = std::filesystem;

/// Of the light, beyond which a window is said to be too small.
constexpr double most_beyond_window = 0.05;

/// "red", "550 nm", "luminance" or "channel 2".
std::string colour_name(const optics::Channels& channels, std::size_t c) {
    static constexpr const char* rgb[] = {"red", "green", "blue"};
    if (is_luminance(channels)) return "luminance";
    return channels.is_rgb() ? std::string(rgb[c]) : channel_name(channels, c);
}

std::optional<std::size_t> drawn_point(const LaminateFactorJob& job, const optics::SampledBssrdf& responses) {
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
        progress.warn(named_warning(
            "not-converged",
            fmt::format("{}: the factorisation stopped at a residual of {:.1e} after {} steps; give it more --steps or "
                        "a larger --tolerance",
                        channel, outcome.factor.residual, outcome.factor.steps)));
    if (outcome.beyond_window > most_beyond_window)
        progress.warn(named_warning(
            "cut-profile",
            fmt::format("{}: {:.1f} % of the light left beyond the window of {:.3g} mm, where the profiles end: they "
                        "are too dark by that; use data of a larger window",
                        channel, 100 * outcome.beyond_window, responses.radius * responses.pitch_mm)));
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
    const ReconstructionError &factored = outcome.factored_checked, &clustered = outcome.clustered_checked;
    return fmt::format(
        "    against {}: {:.1f} %, {:.1f} % in the wrong place (noise alone {:.1f} %); beyond noise {:.1f} %, {:.1f} "
        "%; albedo +-{:.4f}, +-{:.4f}\n",
        file, 100 * factored.light_error, 100 * clustered.light_error, 100 * factored.noise_error,
        100 * factored.excess, 100 * clustered.excess, factored.albedo_error, clustered.albedo_error);
}

void add_error(io::JsonWriter& json, const char* name, const ReconstructionError& error) {
    json.key(name).begin_object().add("light_error", error.light_error).add("noise_error", error.noise_error);
    json.add("excess", error.excess).add("light", error.light).add("albedo_error", error.albedo_error);
    json.add("largest_albedo_error", error.largest_albedo_error).end_object();
}

void add_factored_channel(io::JsonWriter& json, const ChannelOutcome& outcome, bool checked) {
    json.begin_object().add("steps", outcome.factor.steps).add("iterations", outcome.factor.iterations);
    json.add("residual", outcome.factor.residual).add("converged", outcome.factor.converged);
    add_error(json, "factored", outcome.factored);
    add_error(json, "clustered", outcome.clustered);
    json.add("beyond_window", outcome.beyond_window);
    if (checked) {
        add_error(json, "factored_checked", outcome.factored_checked);
        add_error(json, "clustered_checked", outcome.clustered_checked);
    }
    json.end_object();
}

void add_clusters(io::JsonWriter& json, const ProfileMapResult& result, std::size_t points) {
    json.key("clusters").begin_list();
    for (const ProfileCluster& cluster : result.clusters.clusters) {
        json.begin_object().add("points", cluster.points);
        json.add("share", cluster.points / static_cast<double>(points)).add("distance", cluster.distance).end_object();
    }
    json.end_list();
}

std::string result_json(const LaminateFactorJob& job, const io::BssrdfFile& data, const ProfileMapResult& result) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-factor").add("version", 1).add("map", job.out);
    json.add("points", std::array{data.responses.width, data.responses.height});
    json.add("factor_seconds", result.factor_seconds).add("cluster_seconds", result.cluster_seconds);
    json.key("channels").begin_list();
    for (const ChannelOutcome& outcome : result.channels) add_factored_channel(json, outcome, !job.check.empty());
    json.end_list().add("rounds", result.clusters.rounds).add("distance", result.clusters.distance);
    add_clusters(json, result, data.responses.points());
    return json.add("brightest_albedo", result.brightest).add("scale", result.scale).end_object().text();
}

std::string result_text(const LaminateFactorJob& job, const io::BssrdfFile& data, const ProfileMapResult& result) {
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
std::string draw(const LaminateFactorJob& job, const io::BssrdfFile& data, const ProfileMapResult& result,
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

io::BssrdfFile data_of(const LaminateFactorJob& job, const std::string& file) {
    io::BssrdfFile data = io::read_bssrdf(file);
    if (!job.tint.empty()) return tinted(std::move(data), *io::read_picture(job.tint).texture);
    if (!job.luminance) return data;
    if (data.channels.size() == 1)
        throw InputError(fmt::format(
            "--luminance: {} has one channel, {}, and so nothing to make luminance of; leave the option out", file,
            optics::channels_text(data.channels)));
    return luminance_of(data);
}

std::vector<fs::path> outputs(const LaminateFactorJob& job) {
    std::vector<fs::path> files{job.out, io::profile_map_picture(job.out)};
    if (!job.picture.empty()) files.emplace_back(job.picture);
    return files;
}

}  // namespace

void LaminateFactorJob::validate() const {
    map.validate();
    if (!out.ends_with(".json")) throw UsageError(fmt::format("{}: the name of a profile map ends in .json", out));
}

JobResult run_laminate_factor(const LaminateFactorJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs(outputs(job), job.overwrite);
    const io::BssrdfFile data = data_of(job, job.dataset);
    const std::optional<std::size_t> point = drawn_point(job, data.responses);
    const io::BssrdfFile check = job.check.empty() ? io::BssrdfFile() : data_of(job, job.check);
    const ProfileMapResult result = make_profile_map(data, job.map, progress, job.check.empty() ? nullptr : &check);
    io::write_profile_map(result.map, job.out);
    for (std::size_t c = 0; c < result.channels.size(); ++c)
        warn_of(result.channels[c], colour_name(data.channels, c), data.responses, progress);
    std::string text = result_text(job, data, result);
    if (!job.picture.empty()) text += draw(job, data, result, point);
    return {result_json(job, data, result), text};
}

}  // namespace voxtone::scattering
