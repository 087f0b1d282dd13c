// SPDX-License-Identifier: GPL-3.0-or-later
//
// The family `calibrate edge`, and its first step, samples.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"
#include "cli/program/steps.h"
#include "slicer/targets/print_boxes.h"

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

Command add_calibrate_edge_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    CLI::App* command = calibrate.add_subcommand(
        "edge",
        "Find each resin's extinction, albedo and anisotropy from thin slabs laid on a printed black/white edge");
    add_example(*command, "fit profiles.csv --setup setup.json -o my-resins.json");
    std::vector<AddStep> steps;
    for (const auto add :
         {add_calibrate_edge_chart_command, add_calibrate_edge_dictionary_command, add_calibrate_edge_fit_command,
          add_calibrate_edge_photo_command, add_calibrate_edge_samples_command, add_calibrate_edge_simulate_command})
        steps.emplace_back([add, &jobs](CLI::App& edge) { return add(edge, jobs); });
    return add_steps(*command, steps);
}

}  // namespace voxtone::cli
