// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/program/help.h"
#include "cli/stack/stack_commands.h"
#include "cli/stack/stack_options.h"
#include "slicer/stacks/stack_predict_job.h"

namespace voxtone::cli {

namespace {

struct StackPredictArguments {
    slicer::StackPredictJob job;
    RunOptions run;
};

int run(StackPredictArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return slicer::run_stack_predict(a.job, progress); });
}

}  // namespace

Command add_stack_predict_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackPredictArguments>();
    slicer::StackPredictJob& job = arguments->job;
    CLI::App* command = stack.add_subcommand(
        "predict", "Predict what a stack of layers reflects and transmits, and how far light spreads");
    command->add_option("stack", job.stack, "a stack file (voxtone-stack), or layers: \"W 0.3, K 0.1\" (mm, top first)")
        ->type_name("FILE|LAYERS")
        ->required();
    command
        ->add_option("-o,--out", job.files, "file to write, several by repeating: .json (the profiles) or .svg (drawn)")
        ->type_name("FILE")
        ->allow_extra_args(false);
    add_overwrite_option(*command, job.overwrite);
    command->add_flag("--check", job.check, "Monte Carlo of the whole stack beside it");
    add_named_stack_options(*command, job.setting);
    add_detail_options(*command, arguments->run.lengths, job.setting.reach_mm, job.setting.coefficients);
    add_tracing_options(*command, job.paths, job.seed);
    add_run_options(*command, arguments->run);
    add_example(*command, "\"W 0.3, K 0.1\" -o spread.json");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
