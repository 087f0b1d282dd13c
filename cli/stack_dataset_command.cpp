// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/base/units.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/stack_commands.h"
#include "voxtone/io/profiles/bssrdf_file.h"
#include "voxtone/io/profiles/resin_file.h"
#include "voxtone/optics/media/slab_patterns.h"

namespace voxtone::cli {

namespace {

struct StackDatasetArguments {
    optics::SlabOptions slab;
    optics::PointResponseOptions trace;
    std::string pattern, resins = "vero-opaque-clear", out;
    std::string pitch = "0.5mm", thickness = "4mm", layer = "0.2mm", feature = "4mm";
    std::vector<std::uint32_t> points{64};
    std::optional<std::uint64_t> path_seed;
    bool matched = false;
    int threads = 0;
    ConsoleOptions console;
};

CommandResult make_dataset(StackDatasetArguments& a, Progress& progress) {
    optics::SlabOptions& slab_options = a.slab;
    slab_options.pattern = a.pattern == "chess"    ? optics::SlabPattern::chess
                           : a.pattern == "marble" ? optics::SlabPattern::marble
                                                   : optics::SlabPattern::stone;
    slab_options.width = a.trace.width = a.points.front();
    slab_options.height = a.trace.height = a.points.back();
    slab_options.margin = a.trace.margin = a.trace.radius + 4;
    slab_options.pitch_mm = parse_length_mm(a.pitch, "--pitch");
    slab_options.thickness_mm = parse_length_mm(a.thickness, "--thickness");
    slab_options.layer_mm = parse_length_mm(a.layer, "--layer");
    slab_options.feature_mm = parse_length_mm(a.feature, "--feature");
    a.trace.seed = a.path_seed.value_or(slab_options.seed);
    optics::ResinSet set = io::find_resin_set(a.resins);
    if (a.matched) set.eta = 1;
    const std::uint64_t bytes = io::bssrdf_bytes(set.channels.size(), a.trace.width, a.trace.height, a.trace.radius);
    if (bytes > io::most_bssrdf_bytes)
        throw InputError(
            fmt::format("{} x {} points, radius {}, {} channels make a file of {:.1f} GB, more than the {:.1f} GB that "
                        "one may have; take fewer --points or a smaller --radius.",
                        a.trace.width, a.trace.height, a.trace.radius, set.channels.size(),
                        1e-9 * static_cast<double>(bytes), 1e-9 * static_cast<double>(io::most_bssrdf_bytes)));
    const optics::MixtureSlab slab = optics::make_slab(set, slab_options);

    const Stopwatch watch;
    progress.note(fmt::format("the data set will take {:.1f} MB", 1e-6 * static_cast<double>(bytes)));
    progress.begin_stage("trace", set.channels.size() * std::uint64_t{a.trace.width} * a.trace.height, "points");
    io::BssrdfFile data;
    data.channels = set.channels;
    data.responses = optics::trace_point_responses(
        {&slab.volume, &slab.mixtures, optics::Backing::black, optics::Sides::mirrored}, a.trace, &progress);
    progress.end_stage();
    const double seconds = watch.total();
    data.source =
        fmt::format("voxtone stack dataset {}: {}, {} mm thick on black, pattern of {} mm, seed {}, {} paths a point{}",
                    a.pattern, set.name, slab_options.thickness_mm, slab_options.feature_mm, slab_options.seed,
                    a.trace.paths, a.matched ? ", no refractive surface" : "");
    io::write_bssrdf(data, a.out);

    std::vector<double> albedo, beyond;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const auto& total = data.responses.channels[c].total;
        double sum = 0;
        for (const float t : total) sum += static_cast<double>(t);
        albedo.push_back(sum / static_cast<double>(total.size()));
        beyond.push_back(optics::share_beyond_window(data.responses, c));
    }
    const nlohmann::ordered_json json{{"format", "voxtone-stack-dataset"},
                                      {"version", 1},
                                      {"dataset", a.out},
                                      {"points", {a.trace.width, a.trace.height}},
                                      {"bytes", bytes},
                                      {"mean_albedo", albedo},
                                      {"beyond_window", beyond},
                                      {"seconds", seconds}};
    return {
        json.dump(),
        fmt::format(
            "{}: {} x {} points at {} mm, {:.1f} MB; mean albedo {:.3f}; share of light beyond {:.3g} mm {:.4f} (by "
            "channel); {} paths a point and channel in {:.1f} s\n",
            a.out, a.trace.width, a.trace.height, slab_options.pitch_mm, 1e-6 * static_cast<double>(bytes),
            fmt::join(albedo, ", "), a.trace.radius * slab_options.pitch_mm, fmt::join(beyond, ", "), a.trace.paths,
            seconds)};
}

}  // namespace

Command add_stack_dataset_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackDatasetArguments>();
    StackDatasetArguments& a = *arguments;
    CLI::App* command = stack.add_subcommand("dataset",
                                             "Trace how light that enters a heterogeneous slab at one point leaves it "
                                             "at the others: a data set for `stack factor`");
    command
        ->add_option("pattern", a.pattern,
                     "marble: veins; chess: white on black and translucent squares; stone: grains")
        ->check(CLI::IsMember({"marble", "chess", "stone"}))
        ->required();
    command->add_option("-o,--out", a.out, "data set to write (format: docs/heterogeneous.md)")
        ->type_name("FILE")
        ->required();
    command->add_option("--points", a.points, "points a side, or WIDTH,HEIGHT")
        ->delimiter(',')
        ->expected(1, 2)
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    const auto length = [&](const char* name, std::string& value, const char* help) {
        command->add_option(name, value, help)->type_name("LENGTH")->capture_default_str();
    };
    length("--pitch", a.pitch, "between points");
    length("--thickness", a.thickness, "of the slab; it lies on black");
    length("--layer", a.layer, "depth of its voxels");
    length("--feature", a.feature, "edge of a square, distance of veins, size of grains");
    command->add_option("--radius", a.trace.radius, "of the window around a point, in points")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command
        ->add_option("--paths", a.trace.paths,
                     "per point and channel; a value's noise falls with the root of their number")
        ->check(CLI::Range(1u, 1u << 24))
        ->capture_default_str();
    command->add_option("--resins", a.resins, "resin set (`voxtone list resins`) or file, with roles W, K and T")
        ->type_name("SET|FILE")
        ->capture_default_str();
    command->add_flag("--matched", a.matched,
                      "no refractive surface (index-matched on both sides), as stacked profiles have it");
    command->add_option("--seed", a.slab.seed, "seed of the pattern and the paths")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--path-seed", a.path_seed, "seed of the paths alone: the same slab seen once more")
        ->type_name("N");
    add_threads_option(*command, a.threads);
    add_console_options(*command, a.console);
    return [arguments] {
        const ThreadLimit limit(static_cast<std::size_t>(arguments->threads));
        return run_on_console(arguments->console,
                              [&](Progress& progress) { return make_dataset(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
