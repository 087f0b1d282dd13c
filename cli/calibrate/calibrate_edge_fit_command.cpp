// SPDX-License-Identifier: GPL-3.0-or-later
//
// `calibrate edge fit`, and the dictionary that it may be given.
#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/patch_options.h"
#include "cli/program/common_options.h"

namespace voxtone::cli {

namespace {

struct EdgeDictionaryArguments {
    calibration::DictionaryJob job;
    std::string shard = "1/1";
    RunOptions run;
};

// "2/8"
void read_shard(const std::string& text, calibration::DictionaryJob& job) {
    const std::size_t slash = text.find('/');
    const auto number = [&](std::size_t from, std::size_t to, std::size_t& value) {
        const char* end = text.data() + to;
        return std::from_chars(text.data() + from, end, value).ptr == end && to > from;
    };
    if (slash == std::string::npos || !number(0, slash, job.shard) || !number(slash + 1, text.size(), job.shards))
        throw UsageError(fmt::format("--shard: \"{}\"; expected K/N, as in 2/8", text));
}

int run_dictionary(EdgeDictionaryArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        read_shard(a.shard, a.job);
        return jobs.edge_dictionary(a.job, progress);
    });
}

struct EdgeFitArguments {
    calibration::EdgeFitJob job;
    std::string g = "0.4";
    std::vector<double> mu;
    PatchOptions chart;
    RunOptions run;
};

void read_anisotropy(const std::string& text, calibration::EdgeFitOptions& fit) {
    if (text == "shared") {
        fit.anisotropy = calibration::EdgeAnisotropy::shared;
    } else if (text == "each") {
        fit.anisotropy = calibration::EdgeAnisotropy::each;
    } else {
        const char* end = text.data() + text.size();
        if (std::from_chars(text.data(), end, fit.g).ptr != end || text.empty())
            throw UsageError(fmt::format("--g: \"{}\"; expected a number, \"shared\" or \"each\"", text));
    }
}

int run_fit(EdgeFitArguments& a, const CalibrateJobs& jobs) {
    return run_on_console(a.run, [&](Progress& progress) {
        read_anisotropy(a.g, a.job.fit);
        set_patch_model(a.chart, a.job.chart_model, a.job.chart_measured);
        if (!a.mu.empty()) a.job.fit.mu_from = a.mu.front(), a.job.fit.mu_to = a.mu.back();
        return jobs.edge_fit(a.job, progress);
    });
}

}  // namespace

Verb calibrate_edge_dictionary_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeDictionaryArguments>();
    EdgeDictionaryArguments& a = *arguments;
    Verb command(
        "dictionary",
        "Trace the light paths of many resins through the slabs, from which `edge fit` has the profile of any resin.\n"
        "One run serves all albedos and sheets. Stopped, the same command goes on where it was.",
        "--setup setup.json -o edges.dict");
    a.job.grid.g = {0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.8};
    a.job.grid.thickness_mm = {0.5, 1};
    add_out_option(command, a.job.out, "FILE", "dictionary to write", false);
    add_overwrite_option(command, a.job.overwrite);
    command.add("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017",
                {.unit = "FILE"});
    command.add("--thickness", a.job.grid.thickness_mm, "of the slabs, mm",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--g", a.job.grid.g, "anisotropies", {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--sigma-t", a.job.grid.sigma_t, "extinctions, 1/mm; empty: the 38 of the paper, 1 to 30",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--paths", a.job.grid.paths, "from the camera, per run; half as many from sheet and light");
    command.add("--seed", a.job.grid.seed, "seed of the paths");
    command.add("--shard", a.shard, "only the K-th of N parts: K/N", {.unit = "K/N"});
    command.add("--merge", a.job.merge, "shards to put together instead", {.unit = "FILE"});
    command.add("--estimate", a.job.estimate, "only say how long it would take, from a sample of the runs");
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run_dictionary(*arguments, jobs); };
    return command;
}

Verb calibrate_edge_fit_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeFitArguments>();
    EdgeFitArguments& a = *arguments;
    Verb command("fit", "Extinction and albedo of every resin, with their errors, from edge profiles of its slabs",
                 "profiles.csv --setup setup.json -o my-resins.json --report my-resins.html");
    command.add("profiles", a.job.profiles,
                "CSV: resin,thickness_mm,x_mm,R,G,B; x from the black to the white side, a perfect diffuser is 1",
                {.unit = "FILE", .required = true});
    add_out_option(command, a.job.out, "FILE", "resin set to write; errors and doubts beside it, as NAME.edge.json");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017",
                {.unit = "FILE"});
    command.add("--dictionary", a.job.dictionary,
                "of `edge dictionary`, of the same setup; empty: a small one is traced for these slabs",
                {.unit = "FILE"});
    command.add("--report", a.job.report, "page to look at: profiles measured and fitted, errors",
                {.unit = "FILE.html"});
    command.add("--name", a.job.name, "name of the set; empty: that of the file");
    command.add("--g", a.g,
                "mean cosine of the scattering angle: a number, or to be found: shared (one for all) or each (one "
                "a resin, brought to 0.4 by similarity)",
                {.unit = "G"});
    command.add("--mu", a.mu, "range in which the factor on all measured values is searched; one number: it is given",
                {.unit = "FROM,TO", .usual = "0.8,1.1", .separator = ',', .count = {1, 2}});
    command.add("--chart", a.job.chart,
                "patches of a chart (`edge chart`, or a calibration target), CSV as of `calibrate photo`: they "
                "complete what edges do not tell; give --printer with it",
                {.unit = "FILE"});
    add_patch_options(command, a.chart, a.job.chart_measured);
    constexpr std::array of_chart{"--white", "--base", "--under", "--printer", "--pitch"};
    for (Option& option : command.options)
        if (std::ranges::find(of_chart, option.names) != of_chart.end())
            option.rules.needs = "--chart", option.rules.group = "Chart";
    command.add("--lambda", a.job.fit.metric.lambda, "weight of gradients against values", {.group = "Metric"});
    command.add("--wavelet-level", a.job.fit.metric.wavelet_level,
                "scale of the wavelet that takes gradients, 2^level samples", {.group = "Metric"});
    command.add("--paths", a.job.paths, "from the camera, per run of its own dictionary");
    command.add("--seed", a.job.seed, "seed of the paths of its own dictionary");
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] { return run_fit(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
