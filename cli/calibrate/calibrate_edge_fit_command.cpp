// SPDX-License-Identifier: GPL-3.0-or-later
//
// `calibrate edge fit`, and the dictionary that it may be given.
#include <charconv>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/calibrate/patch_options.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"

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

CLI::Option* add_list(CLI::App& command, const char* name, std::vector<double>& values, const char* help) {
    return command.add_option(name, values, help)->type_name("LIST")->delimiter(',')->allow_extra_args(false);
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

Command add_calibrate_edge_dictionary_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeDictionaryArguments>();
    EdgeDictionaryArguments& a = *arguments;
    CLI::App* command = edge.add_subcommand(
        "dictionary",
        "Trace the light paths of many resins through the slabs, from which `edge fit` has the profile of any resin.\n"
        "One run serves all albedos and sheets. Stopped, the same command goes on where it was.");
    a.job.grid.g = {0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.8};
    a.job.grid.thickness_mm = {0.5, 1};
    add_out_option(*command, a.job.out, "FILE", "dictionary to write")->required(false);
    add_overwrite_option(*command, a.job.overwrite);
    command->add_option("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017")
        ->type_name("FILE");
    add_list(*command, "--thickness", a.job.grid.thickness_mm, "of the slabs, mm")->default_str("0.5,1");
    add_list(*command, "--g", a.job.grid.g, "anisotropies")->default_str("0,0.1,0.2,0.3,0.4,0.45,0.5,0.55,0.6,0.7,0.8");
    add_list(*command, "--sigma-t", a.job.grid.sigma_t, "extinctions, 1/mm; empty: the 38 of the paper, 1 to 30");
    add_count(*command, "--paths", a.job.grid.paths, "from the camera, per run; half as many from sheet and light");
    add_seed_option(*command, a.job.grid.seed, "seed of the paths");
    command->add_option("--shard", a.shard, "only the K-th of N parts: K/N")->capture_default_str()->type_name("K/N");
    command->add_option("--merge", a.job.merge, "shards to put together instead")->type_name("FILE");
    command->add_flag("--estimate", a.job.estimate, "only say how long it would take, from a sample of the runs");
    add_run_options(*command, a.run);
    add_example(*command, "--setup setup.json -o edges.dict");
    return [arguments, &jobs] { return run_dictionary(*arguments, jobs); };
}

Command add_calibrate_edge_fit_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeFitArguments>();
    EdgeFitArguments& a = *arguments;
    CLI::App* command = edge.add_subcommand(
        "fit", "Extinction and albedo of every resin, with their errors, from edge profiles of its slabs");
    command
        ->add_option("profiles", a.job.profiles,
                     "CSV: resin,thickness_mm,x_mm,R,G,B; x from the black to the white side, a perfect diffuser is 1")
        ->required()
        ->type_name("FILE");
    add_out_option(*command, a.job.out, "FILE", "resin set to write; errors and doubts beside it, as NAME.edge.json");
    add_overwrite_option(*command, a.job.overwrite);
    command->add_option("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017")
        ->type_name("FILE");
    command
        ->add_option("--dictionary", a.job.dictionary,
                     "of `edge dictionary`, of the same setup; empty: a small one is traced for these slabs")
        ->type_name("FILE");
    command->add_option("--report", a.job.report, "page to look at: profiles measured and fitted, errors")
        ->type_name("FILE.html");
    command->add_option("--name", a.job.name, "name of the set; empty: that of the file");
    command
        ->add_option("--g", a.g,
                     "mean cosine of the scattering angle: a number, or to be found: shared (one for all) or each (one "
                     "a resin, brought to 0.4 by similarity)")
        ->capture_default_str()
        ->type_name("G");
    command
        ->add_option("--mu", a.mu,
                     "range in which the factor on all measured values is searched; one number: it is given")
        ->type_name("FROM,TO")
        ->delimiter(',')
        ->expected(1, 2)
        ->default_str("0.8,1.1");
    command
        ->add_option("--chart", a.job.chart,
                     "patches of a chart (`edge chart`, or a calibration target), CSV as of `calibrate photo`: they "
                     "complete what edges do not tell; give --printer with it")
        ->type_name("FILE");
    add_patch_options(*command, a.run.lengths, a.chart, a.job.chart_measured);
    for (const char* option : {"--white", "--base", "--under", "--printer", "--pitch"})
        command->get_option(option)->needs("--chart")->group("Chart");
    add_value(*command, "--lambda", a.job.fit.metric.lambda, "weight of gradients against values")->group("Metric");
    add_value(*command, "--wavelet-level", a.job.fit.metric.wavelet_level,
              "scale of the wavelet that takes gradients, 2^level samples")
        ->group("Metric");
    add_count(*command, "--paths", a.job.paths, "from the camera, per run of its own dictionary");
    add_seed_option(*command, a.job.seed, "seed of the paths of its own dictionary");
    add_run_options(*command, a.run);
    add_example(*command, "profiles.csv --setup setup.json -o my-resins.json --report my-resins.html");
    return [arguments, &jobs] { return run_fit(*arguments, jobs); };
}

}  // namespace voxtone::cli
