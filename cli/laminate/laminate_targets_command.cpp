// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
#include "scattering/jobs/laminate_targets_job.h"

namespace voxtone::cli {

namespace {

struct LaminateTargetsArguments {
    scattering::LaminateTargetsJob job;
    RunOptions run;
};

int run(LaminateTargetsArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_targets(a.job, progress); });
}

}  // namespace

Verb laminate_targets_verb() {
    auto arguments = std::make_shared<LaminateTargetsArguments>();
    scattering::LaminateTargetsJob& job = arguments->job;
    Verb command("targets", "Make targets of one albedo and rising width, between two laminates",
                 "\"W 4\" \"W 0.2, T 0.8, W 3\" --resins vero-opaque-clear -o targets");
    command.add("narrow", job.narrow, "where light spreads least: a laminate file, or layers: \"W 5\" (mm, top first)",
                {.unit = "FILE|LAYERS", .required = true});
    command.add("wide", job.wide, "where light spreads most: \"W 0.2, T 4.8\"",
                {.unit = "FILE|LAYERS", .required = true});
    add_file_folder_options(command, job.out, job.overwrite,
                            "folder for target-1.json (narrowest), target-2.json, ... and targets.svg");
    command.add("--count", job.count, "targets, from 1 to 1000");
    add_named_laminate_options(command, job.setting);
    add_detail_options(command, job.setting.reach_mm, job.setting.coefficients);
    add_tracing_options(command, job.paths, job.seed);
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
