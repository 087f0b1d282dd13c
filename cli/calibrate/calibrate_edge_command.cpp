// SPDX-License-Identifier: GPL-3.0-or-later
//
// The family `calibrate edge`, and its first step, samples.
#include <memory>
#include <string>
#include <vector>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "slicer/print/print_boxes.h"

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

Verb calibrate_edge_samples_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<EdgeSamplesArguments>();
    EdgeSamplesArguments& a = *arguments;
    Verb command("samples",
                 "Make what is measured: slabs of every resin as a stack, and the sheet with the edges (SVG, A4)",
                 "--resins C,M,Y,K,W --allowance 0.05mm -o slabs");
    add_printer_option(command, a.printer);
    command.add("--resins", a.job.roles, "roles of the resins: C,M,Y,K,W",
                {.unit = "ROLES", .required = true, .one_each = true, .separator = ','});
    command.add("--thickness", a.job.thickness_mm, "of the slabs when they are polished, mm",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--allowance", length(a.job.allowance_mm), "printed more, for what polishing takes off");
    command.add("--size", length(a.job.edge_mm), "edge of a slab");
    command.add("--gap", length(a.job.gap_mm), "between slabs");
    add_stack_folder_options(command, a.job.out, a.overwrite);
    add_run_options(command, a.run);
    command.run = [arguments, &jobs] {
        return run_on_console(arguments->run,
                              [&](Progress& progress) { return make_samples(*arguments, jobs, progress); });
    };
    return command;
}

Verb calibrate_edge_verb(const CalibrateJobs& jobs) {
    Verb command(
        "edge",
        "Find each resin's extinction, albedo and anisotropy from thin slabs laid on a printed black/white edge",
        "fit profiles.csv --setup setup.json -o my-resins.json");
    command.steps = {calibrate_edge_chart_verb(jobs),   calibrate_edge_dictionary_verb(jobs),
                     calibrate_edge_fit_verb(jobs),     calibrate_edge_photo_verb(jobs),
                     calibrate_edge_samples_verb(jobs), calibrate_edge_simulate_verb(jobs)};
    return command;
}

}  // namespace voxtone::cli
