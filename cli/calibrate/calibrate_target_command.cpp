// SPDX-License-Identifier: GPL-3.0-or-later
//
// The only place that knows both how a target is laid out (calibration) and how a printer makes it (slicer).
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"
#include "cli/program/option_text.h"
#include "io/profiles/resin_file.h"
#include "slicer/targets/print_boxes.h"

namespace voxtone::cli {

namespace {

struct CalibrateTargetArguments {
    calibration::TargetJob job;
    std::string printer = "stratasys-j750-hm", layout = "B";
    std::uint64_t seed = 1;
    bool overwrite = false;
    io::StackOutputs outputs;
    RunOptions run;
};

/// Roles as the known resins have them, where they differ in capitals alone; words of the user's own stay.
void write_roles_as_known(calibration::TargetJob& job) {
    const optics::ResinSet known = io::find_resin_set(job.resin_set.empty() ? "vero-opaque-clear" : job.resin_set);
    const auto write = [&](std::string& role) {
        if (const int found = known.find(role); found >= 0) role = known.resins[std::size_t(found)].role;
    };
    for (std::string& role : job.layout.roles) write(role);
    write(job.layout.light);
    write(job.layout.dark);
}

void set_printer(const slicer::PrinterProfile& printer, calibration::TargetJob& job) {
    job.layout.printer = printer.id;
    const Eigen::Vector3d pitch_um = printer.sliced_pitch_um();
    job.layout.pitch_um = {pitch_um.x(), pitch_um.y(), pitch_um.z()};
    job.display_rgb = printer.display_colours(job.layout.roles);
}

slicer::BoxPrint box_print(const CalibrateTargetArguments& a, const std::vector<calibration::TargetBox>& boxes,
                           const Eigen::Vector3d& size_mm) {
    slicer::BoxPrint print;
    for (const calibration::TargetBox& box : boxes) print.boxes.push_back({box.min_mm, box.max_mm, box.fractions});
    print.size_mm = size_mm;
    print.roles = a.job.layout.roles;
    print.seed = a.seed;
    return print;
}

JobResult make_target(CalibrateTargetArguments& a, const CalibrateJobs& jobs, Progress& progress) {
    const slicer::PrinterProfile printer = slicer::find_printer(a.printer);
    for (const std::string& warning : printer.warnings()) progress.warn(warning);
    write_roles_as_known(a.job);
    set_printer(printer, a.job);
    const auto print = [&](const auto& boxes, const Eigen::Vector3d& size_mm, Progress& to) {
        return slicer::print_boxes(box_print(a, boxes, size_mm), printer, a.job.out, a.outputs, a.overwrite, to);
    };
    return jobs.target(a.job, print, progress);
}

int run(CalibrateTargetArguments& a, const CalibrateJobs& jobs) {
    if (a.job.patches == 0) a.job.layout.layout = static_cast<calibration::TargetLayout>(a.layout[0] - 'A');
    return run_on_console(a.run, [&](Progress& progress) { return make_target(a, jobs, progress); });
}

void add_size_options(CLI::App& command, calibration::TargetOptions& layout, LengthOptions& lengths) {
    lengths.add(command, "--square", layout.square_mm, "edge of a square")->group(fine_tuning);
    lengths.add(command, "--top", layout.top_mm, "thickness of the squares, rounded to whole layers")
        ->group(fine_tuning);
    lengths.add(command, "--base", layout.base_mm, "thickness of the base under them, rounded up to whole layers")
        ->group(fine_tuning);
    lengths.add(command, "--gap", layout.gap_mm, "between squares")->group(fine_tuning);
    lengths.add(command, "--marker", layout.marker_mm, "edge of a marker")->group(fine_tuning);
    lengths.add(command, "--quiet-zone", layout.quiet_mm, "light around a marker")->group(fine_tuning);
}

void add_layout_options(CLI::App& command, calibration::TargetOptions& layout, LengthOptions& lengths) {
    add_value(command, "--light", layout.light, "role of the resin of the light half and of the frame")
        ->type_name("ROLE");
    add_value(command, "--dark", layout.dark, "role of the resin of the dark half and of the markers")
        ->type_name("ROLE");
    add_size_options(command, layout, lengths);
}

/// All but the layout.
void add_target_options(CLI::App* command, CalibrateTargetArguments& a) {
    add_printer_option(*command, a.printer);
    command->add_option("--resins", a.job.layout.roles, "roles of the resins, two or more: C,M,Y,K,W")
        ->type_name("ROLES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->required();
    add_stack_folder_options(*command, a.job.out, a.overwrite);
    command
        ->add_option(
            "--resin-set", a.job.resin_set,
            "resins as far as they are known already: says whether the base is opaque, and colours the picture")
        ->type_name("SET|FILE");
    add_layout_options(*command, a.job.layout, a.run.lengths);
    add_count(*command, "--seed", a.seed, "seed of the dither")->group(fine_tuning);
    command->add_flag("--gcvf", a.outputs.gcvf, "write a GCVF container too");
    add_run_options(*command, a.run);
}

}  // namespace

Command add_calibrate_target_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    CLI::App* command = calibrate.add_subcommand(
        "target", "Make the printable target: a stack, its description (target.json) and a picture of it");
    add_value(*command, "--layout", arguments->layout,
              "A: pure resins; B: and 10:90 mixtures; C: and 5, 25, 50 %; E: all equal mixtures")
        ->check(CLI::IsMember({"A", "B", "C", "E"}));
    add_target_options(command, *arguments);
    add_example(*command, "--resins C,M,Y,K,W --resin-set vero-opaque -o target");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

Command add_calibrate_chart_command(CLI::App& calibrate, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    calibration::TargetOptions& layout = arguments->job.layout;
    arguments->job.patches = 120;
    layout.square_mm = 8, layout.top_mm = 2, layout.base_mm = 1, layout.gap_mm = 1;
    CLI::App* command = calibrate.add_subcommand(
        "chart",
        "Make a printable chart of the mixtures that tell most: a stack, a form for the spectrophotometer (chart.csv), "
        "its\ndescription (target.json) and a picture");
    add_count(*command, "--patches", arguments->job.patches, "mixtures: 30, 60, 120, 242 or any number");
    add_target_options(command, *arguments);
    add_example(*command, "--resins C,M,Y,K,W --patches 120 -o chart");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

Command add_calibrate_edge_chart_command(CLI::App& edge, const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    arguments->layout = "E";
    CLI::App* command = edge.add_subcommand("chart",
                                            "Make the chart of all equal mixtures of the resins, from which `edge fit "
                                            "--chart` has what edges do not tell:\n"
                                            "a stack, its description (target.json, for `calibrate photo`) and a "
                                            "picture. It is `calibrate target --layout E`.");
    add_target_options(command, *arguments);
    add_example(*command, "--resins C,M,Y,K,W --resin-set vero-opaque -o chart");
    return [arguments, &jobs] { return run(*arguments, jobs); };
}

}  // namespace voxtone::cli
