// SPDX-License-Identifier: GPL-3.0-or-later
//
// The family `calibrate edge`, and its steps that need no fit: samples and simulate.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "voxtone/cli/calibrate/calibrate_commands.h"
#include "voxtone/cli/program/common_options.h"
#include "voxtone/cli/program/help.h"
#include "voxtone/cli/program/steps.h"
#include "voxtone/slicer/stacks/print_boxes.h"

namespace voxtone::cli {

namespace {

struct EdgeSamplesArguments {
    calibration::EdgeSamplesJob job;
    std::string printer = "stratasys-j750-hm";
    bool overwrite = false;
    RunOptions run;
};

JobResult make_samples(EdgeSamplesArguments& a, const CalibrateJobs& jobs, Progress& progress) {
    const slicer::PrinterProfile printer = slicer::find_printer(a.printer);
    for (const std::string& warning : printer.warnings()) progress.warn(warning);
    const auto print = [&](const auto& boxes, const Eigen::Vector3d& size_mm, Progress& to) {
        slicer::BoxPrint slabs;
        for (const calibration::TargetBox& box : boxes) slabs.boxes.push_back({box.min_mm, box.max_mm, box.fractions});
        slabs.size_mm = size_mm;
        slabs.roles = a.job.roles;
        return slicer::print_boxes(slabs, printer, a.job.out, {}, a.overwrite, to);
    };
    return jobs.edge_samples(a.job, print, progress);
}

struct EdgeSimulateArguments {
    calibration::EdgeSimulationJob job;
    RunOptions run;
};

}  // namespace

Command add_calibrate_edge_samples_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeSamplesArguments>();
    EdgeSamplesArguments& a = *arguments;
    CLI::App* command = edge.add_subcommand(
        "samples", "Make what is measured: slabs of every resin as a stack, and the sheet with the edges (SVG, A4)");
    add_printer_option(*command, a.printer);
    command->add_option("--resins", a.job.roles, "roles of the resins: C,M,Y,K,W")
        ->type_name("ROLES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->required();
    command->add_option("--thickness", a.job.thickness_mm, "of the slabs when they are polished, mm")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->default_str("0.5,1");
    a.run.lengths.add(*command, "--allowance", a.job.allowance_mm, "printed more, for what polishing takes off");
    a.run.lengths.add(*command, "--size", a.job.edge_mm, "edge of a slab");
    a.run.lengths.add(*command, "--gap", a.job.gap_mm, "between slabs");
    add_stack_folder_options(*command, a.job.out, a.overwrite);
    add_run_options(*command, a.run);
    add_example(*command, "--resins C,M,Y,K,W --allowance 0.05mm -o slabs");
    return [arguments, &jobs] {
        return run_on_console(arguments->run,
                              [&](Progress& progress) { return make_samples(*arguments, jobs, progress); });
    };
}

Command add_calibrate_edge_simulate_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeSimulateArguments>();
    EdgeSimulateArguments& a = *arguments;
    CLI::App* command = edge.add_subcommand(
        "simulate", "Render the edge profiles that slabs of known resins would give: a rehearsal without a bench");
    add_resins_option(*command, a.job.resins, ", RGB");
    command->add_option("--roles", a.job.roles, "resins of the set; empty: all")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--setup", a.job.setup, "figures of the bench (setup.json); empty: those of the paper of 2017")
        ->type_name("FILE");
    command->add_option("--thickness", a.job.thickness_mm, "of the slabs, mm")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->default_str("0.5,1");
    add_out_option(*command, a.job.out, "FILE", "profiles to write (.csv)");
    add_overwrite_option(*command, a.job.overwrite);
    calibration::EdgeBench& bench = a.job.bench;
    const auto fault = [&](const char* name, double& value, const char* help) {
        add_value(*command, name, value, help)->group("Faults of the bench");
    };
    fault("--bias", bench.bias, "values are divided by it: the mu that a fit should find");
    fault("--noise", bench.noise, "standard error of a sample of reflectance 1");
    fault("--thickness-off", bench.thickness_off, "slabs are thicker than they are said to be, by this part");
    add_count(*command, "--paths", bench.paths, "per resin, slab and channel");
    add_seed_option(*command, bench.seed, "seed of paths and noise");
    add_run_options(*command, a.run);
    add_example(*command, "--resins vero-opaque --setup setup.json --bias 0.913 -o profiles.csv");
    return [arguments, &jobs] {
        return run_on_console(arguments->run,
                              [&](Progress& progress) { return jobs.edge_simulate(arguments->job, progress); });
    };
}

Command add_calibrate_edge_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    CLI::App* command = calibrate.add_subcommand(
        "edge",
        "Find each resin's extinction, albedo and anisotropy from thin slabs laid on a printed black/white edge");
    add_example(*command, "fit profiles.csv --setup setup.json -o my-resins.json");
    std::vector<AddStep> steps;
    for (const auto add :
         {add_calibrate_edge_chart_command, add_calibrate_edge_dictionary_command, add_calibrate_edge_fit_command,
          add_calibrate_edge_samples_command, add_calibrate_edge_simulate_command})
        steps.emplace_back([add, &jobs](CLI::App& edge) { return add(edge, jobs); });
    return add_steps(*command, steps);
}

}  // namespace voxtone::cli
