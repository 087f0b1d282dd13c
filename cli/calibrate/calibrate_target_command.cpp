// SPDX-License-Identifier: GPL-3.0-or-later
//
// The only place that knows both how a target is laid out (calibration) and how a printer makes it (slicer).
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/calibrate/calibrate_commands.h"
#include "cli/program/common_options.h"
#include "io/profiles/resin_file.h"
#include "slicer/print/print_boxes.h"

namespace voxtone::cli {

namespace {

struct CalibrateTargetArguments {
    calibration::TargetJob job;
    std::string printer = "stratasys-j750-hm", layout = "B";
    std::optional<std::size_t> thin;
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
    // Nothing but squares makes its height.
    if (!job.surfaces.empty())
        job.layout.top_mm = std::max(job.layout.top_mm, printer.min_layers * pitch_um.z() / 1000);
    job.display_rgb = printer.display_colours(job.layout.roles);
}

slicer::BoxPrint box_print(const CalibrateTargetArguments& a, const std::vector<calibration::TargetBox>& boxes,
                           const Eigen::Vector3d& size_mm) {
    slicer::BoxPrint print;
    for (const calibration::TargetBox& box : boxes)
        print.boxes.push_back({box.min_mm, box.max_mm, box.fractions, box.cell});
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
    if (!a.job.surfaces.empty() && a.job.layout.base_mm != calibration::TargetOptions{}.base_mm)
        throw UsageError("--base with --surface: would be ignored: squares are printed upon the surface; leave it out");
    const bool thin = a.layout == "chart";
    if (a.thin && !thin)
        throw UsageError(fmt::format(
            "--patches with --layout {}: would be ignored; the thin mixtures are --layout chart", a.layout));
    if (a.job.strips && (thin || a.layout == "E"))
        throw UsageError(fmt::format(
            "--strips with --layout {}: `calibrate fit` reads them beside the squares that tell the resins; take A, B "
            "or C",
            a.layout));
    if (thin)
        a.job.thin = a.thin.value_or(121);
    else if (a.job.patches == 0)
        a.job.layout.layout = static_cast<calibration::TargetLayout>(a.layout[0] - 'A');
    return run_on_console(a.run, [&](Progress& progress) { return make_target(a, jobs, progress); });
}

void add_size_options(Verb& command, calibration::TargetOptions& layout) {
    command.add("--square", length(layout.square_mm), "edge of a square", {.group = fine_tuning});
    command.add("--top", length(layout.top_mm), "thickness of the squares, rounded to whole layers",
                {.group = fine_tuning});
    command.add("--base", length(layout.base_mm), "thickness of the base under them, rounded up to whole layers",
                {.group = fine_tuning});
    command.add("--gap", length(layout.gap_mm), "between squares", {.group = fine_tuning});
    command.add("--marker", length(layout.marker_mm), "edge of a marker", {.group = fine_tuning});
    command.add("--quiet-zone", length(layout.quiet_mm), "light around a marker", {.group = fine_tuning});
}

void add_layout_options(Verb& command, calibration::TargetOptions& layout) {
    command.add("--light", layout.light, "resin, or surface, of the light half and of the frame", {.unit = "ROLE"});
    command.add("--dark", layout.dark, "the same of the dark half, and of the markers", {.unit = "ROLE"});
    add_size_options(command, layout);
}

/// All but the layout.
void add_target_options(Verb& command, CalibrateTargetArguments& a) {
    add_printer_option(command, a.printer);
    command.add("--resins", a.job.layout.roles, "roles of the resins, two or more: C,M,Y,K,W",
                {.unit = "ROLES", .required = true, .one_each = true, .separator = ','});
    add_stack_folder_options(command, a.job.out, a.overwrite);
    command.add("--resin-set", a.job.resin_set,
                "resins as far as they are known already: says whether the base is opaque, and colours the picture",
                {.unit = "SET|FILE"});
    add_layout_options(command, a.job.layout);
    command.add("--seed", a.seed, "seed of the dither", {.group = fine_tuning});
    command.add("--gcvf", a.outputs.gcvf, "write a GCVF container too");
    add_run_options(command, a.run);
}

}  // namespace

Verb calibrate_target_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    Verb command("target", "Make the printable target: a stack, its description (target.json) and a picture of it",
                 "--resins C,M,Y,K,W --resin-set vero-opaque -o target");
    command.add("--layout", arguments->layout,
                "A: pure resins; B: and 10:90 mixtures; C: and 5, 25, 50 %; E: all equal mixtures; chart: thin "
                "mixtures for `calibrate check`, which take no part in a fit",
                {.choices = {"A", "B", "C", "E", "chart"}});
    command.add("--patches", arguments->thin, "mixtures of --layout chart, each on light and on dark; empty: 121");
    command.add(
        "--strips", arguments->job.strips,
        "checkers of growing cells besides, of the light resin and the one that tells most beside it, from which "
        "`calibrate fit` finds how far resin runs before it is cured");
    command.add("--surface", arguments->job.surfaces,
                "what it is printed upon instead of a base, for --light and for --dark, such as the halves of a card: "
                "name, matt, smooth or mirror (+gap over air), and what it reflects bare, once or in linear R, G, B",
                {.unit = "NAME=KIND:R", .one_each = true});
    add_target_options(command, *arguments);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

Verb calibrate_chart_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    calibration::TargetOptions& layout = arguments->job.layout;
    arguments->job.patches = 120;
    layout.square_mm = 8, layout.top_mm = 2, layout.base_mm = 1, layout.gap_mm = 1;
    Verb command(
        "chart",
        "Make a printable chart of the mixtures that tell most: a stack, a form for the spectrophotometer (chart.csv), "
        "its\ndescription (target.json) and a picture",
        "--resins C,M,Y,K,W --patches 120 -o chart");
    command.add("--patches", arguments->job.patches, "mixtures: 30, 60, 120, 242 or any number");
    add_target_options(command, *arguments);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

Verb calibrate_edge_chart_verb(const CalibrateJobs& jobs) {
    auto arguments = std::make_shared<CalibrateTargetArguments>();
    arguments->layout = "E";
    Verb command("chart",
                 "Make the chart of all equal mixtures of the resins, from which `edge fit "
                 "--chart` has what edges do not tell:\n"
                 "a stack, its description (target.json, for `calibrate photo`) and a "
                 "picture. It is `calibrate target --layout E`.",
                 "--resins C,M,Y,K,W --resin-set vero-opaque -o chart");
    add_target_options(command, *arguments);
    command.run = [arguments, &jobs] { return run(*arguments, jobs); };
    return command;
}

}  // namespace voxtone::cli
