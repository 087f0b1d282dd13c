// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/stack_commands.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/bssrdf_file.h"
#include "voxtone/io/profiles/profile_map.h"
#include "voxtone/slicer/stacks/profile_map_job.h"

namespace voxtone::cli {

namespace {

struct StackFactorArguments {
    slicer::ProfileMapOptions options;
    std::string dataset, check, out, picture;
    std::vector<std::uint32_t> point;
    double max_albedo = 0;
    int threads = 0;
    ConsoleOptions console;
};

std::string channel_name(const optics::Channels& channels, std::size_t c) {
    static constexpr const char* rgb[] = {"red", "green", "blue"};
    return channels.is_rgb() ? std::string(rgb[c]) : fmt::format("{} nm", channels.wavelengths_nm[c]);
}

nlohmann::ordered_json error_json(const halftone::ReconstructionError& error) {
    return {{"light_error", error.light_error},
            {"noise_error", error.noise_error},
            {"excess", error.excess},
            {"light", error.light},
            {"albedo_error", error.albedo_error},
            {"largest_albedo_error", error.largest_albedo_error}};
}

CommandResult factor(StackFactorArguments& a, Progress& progress) {
    if (a.max_albedo != 0) a.options.max_albedo = a.max_albedo;
    a.options.validate();
    const io::BssrdfFile data = io::read_bssrdf(a.dataset);
    std::optional<std::size_t> point;
    if (!a.point.empty()) {
        if (a.point[0] >= data.responses.width || a.point[1] >= data.responses.height)
            throw UsageError(fmt::format("--point {},{} lies outside of {}, which has {} x {} points, counted from 0.",
                                         a.point[0], a.point[1], a.dataset, data.responses.width,
                                         data.responses.height));
        point = std::size_t{a.point[1]} * data.responses.width + a.point[0];
    }
    const io::BssrdfFile check = a.check.empty() ? io::BssrdfFile() : io::read_bssrdf(a.check);
    const slicer::ProfileMapResult result =
        slicer::make_profile_map(data, a.options, progress, a.check.empty() ? nullptr : &check);
    io::write_profile_map(result.map, a.out);
    std::string text = fmt::format(
        "{}: {} x {} points, factored in {:.1f} s, {} clusters in {:.1f} s ({} rounds, distance {:.4f})\n", a.out,
        data.responses.width, data.responses.height, result.factor_seconds, result.clusters.clusters.size(),
        result.cluster_seconds, result.clusters.rounds, result.clusters.distance);
    nlohmann::ordered_json channels = nlohmann::ordered_json::array(), clusters = nlohmann::ordered_json::array();
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
        const slicer::ChannelOutcome& outcome = result.channels[c];
        const auto& [steps, iterations, residual, converged] = outcome.factor;
        if (!converged)
            progress.warn(
                fmt::format("{}: the factorisation stopped at a residual of {:.1e} after {} steps; give it more "
                            "--steps or a larger "
                            "--tolerance",
                            channel_name(data.channels, c), residual, steps));
        if (outcome.beyond_window > 0.05)
            progress.warn(
                fmt::format("{}: {:.1f} % of the light left beyond the window of {:.3g} mm, where the profiles end: "
                            "they are too dark "
                            "by that; use data of a larger window",
                            channel_name(data.channels, c), 100 * outcome.beyond_window,
                            data.responses.radius * data.responses.pitch_mm));
        text += fmt::format(
            "  {}: {} steps, {} iterations, residual {:.1e}; light in the wrong place {:.1f} % factored, {:.1f} % "
            "clustered "
            "(noise alone {:.1f} %); light kept {:.4f}, {:.4f}; albedo +-{:.4f}, +-{:.4f}; "
            "{:.1f} % of the light left beyond the window\n",
            channel_name(data.channels, c), steps, iterations, residual, 100 * outcome.factored.light_error,
            100 * outcome.clustered.light_error, 100 * outcome.factored.noise_error, outcome.factored.light,
            outcome.clustered.light, outcome.factored.albedo_error, outcome.clustered.albedo_error,
            100 * outcome.beyond_window);
        if (!a.check.empty())
            text += fmt::format(
                "    against {}: {:.1f} %, {:.1f} % in the wrong place (noise alone {:.1f} %); beyond noise {:.1f} %, "
                "{:.1f} %; "
                "albedo +-{:.4f}, +-{:.4f}\n",
                a.check, 100 * outcome.factored_checked.light_error, 100 * outcome.clustered_checked.light_error,
                100 * outcome.factored_checked.noise_error, 100 * outcome.factored_checked.excess,
                100 * outcome.clustered_checked.excess, outcome.factored_checked.albedo_error,
                outcome.clustered_checked.albedo_error);
        channels.push_back({{"steps", steps},
                            {"iterations", iterations},
                            {"residual", residual},
                            {"converged", converged},
                            {"factored", error_json(outcome.factored)},
                            {"clustered", error_json(outcome.clustered)},
                            {"beyond_window", outcome.beyond_window}});
        if (!a.check.empty()) {
            channels.back()["factored_checked"] = error_json(outcome.factored_checked);
            channels.back()["clustered_checked"] = error_json(outcome.clustered_checked);
        }
    }
    for (const halftone::ProfileCluster& cluster : result.clusters.clusters)
        clusters.push_back({{"points", cluster.points},
                            {"share", cluster.points / static_cast<double>(data.responses.points())},
                            {"distance", cluster.distance}});
    text += fmt::format("  brightest profile {:.4f}, scaled by {:.4f}\n", result.brightest, result.scale);
    if (!a.picture.empty()) {
        const slicer::ComparisonPicture drawn = slicer::draw_comparison(data, result, point);
        io::write_whole_file(a.picture, io::png_bytes(drawn.picture));
        text += fmt::format(
            "  {}: albedo; mean distance {:.2f} to {:.2f} mm ({}); response of point ({}, {}), {:.2g} to {:.2g} per "
            "mm2; data, "
            "factored, clustered\n",
            a.picture, drawn.least_mm, drawn.most_mm, channel_name(data.channels, drawn.channel),
            drawn.point % data.responses.width, drawn.point / data.responses.width, drawn.least_per_mm2,
            drawn.most_per_mm2);
    }
    const nlohmann::ordered_json json{{"format", "voxtone-stack-factor"},
                                      {"version", 1},
                                      {"map", a.out},
                                      {"points", {data.responses.width, data.responses.height}},
                                      {"factor_seconds", result.factor_seconds},
                                      {"cluster_seconds", result.cluster_seconds},
                                      {"channels", channels},
                                      {"rounds", result.clusters.rounds},
                                      {"distance", result.clusters.distance},
                                      {"clusters", clusters},
                                      {"brightest_albedo", result.brightest},
                                      {"scale", result.scale}};
    return {json.dump(), text};
}

}  // namespace

Command add_stack_factor_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackFactorArguments>();
    StackFactorArguments& a = *arguments;
    CLI::App* command = stack.add_subcommand("factor",
                                             "Find the scattering profile of each point of a heterogeneous surface, "
                                             "and the few that stand for all: a profile map");
    command->add_option("dataset", a.dataset, "data set: measured, or of `stack dataset`")
        ->type_name("FILE")
        ->required();
    command->add_option("-o,--out", a.out, "profile map to write: NAME.json, with NAME.png beside it")
        ->type_name("FILE")
        ->required()
        ->check([](const std::string& name) {
            return name.ends_with(".json") ? std::string() : "the name of a profile map ends in .json";
        });
    command->add_option("--clusters", a.options.clusters.clusters, "profiles to keep, at most")
        ->check(CLI::Range(1, 65535))
        ->capture_default_str();
    command
        ->add_option("--max-albedo", a.max_albedo,
                     "scale all profiles so that the brightest reflects this much; 0: as they are")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command
        ->add_option("--curvature", a.options.factor.curvature,
                     "how much the slope of ln P is expected to change from point to point; smaller is smoother")
        ->capture_default_str();
    command
        ->add_option("--tolerance", a.options.factor.tolerance,
                     "share of the light that may be left out of place when it stops")
        ->capture_default_str();
    command->add_option("--steps", a.options.factor.max_steps, "most steps")->capture_default_str();
    command
        ->add_option("--check", a.check,
                     "other data of the same surface: says how far profiles are wrong, without the noise")
        ->type_name("FILE");
    command->add_option("--picture", a.picture, "write data, factored and clustered surface side by side")
        ->type_name("PNG");
    command->add_option("--point", a.point, "X,Y of the point whose response is drawn; by default one in the middle")
        ->delimiter(',')
        ->expected(2);
    command->add_option("--seed", a.options.clusters.seed, "seed of the clusters")
        ->type_name("N")
        ->capture_default_str();
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console, [&](Progress& progress) { return factor(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
