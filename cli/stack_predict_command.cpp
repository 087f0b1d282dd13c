// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/stack_commands.h"
#include "voxtone/slicer/stacks/stack_predict_job.h"

namespace voxtone::cli {

namespace {

struct StackPredictArguments {
    slicer::StackPredictJob job;
    std::string reach = "10mm";
    int threads = 0;
    ConsoleOptions console;
};

int run(StackPredictArguments& a) {
    a.job.reach_mm = parse_length_mm(a.reach, "--reach");
    const ThreadLimit limit(static_cast<std::size_t>(a.threads));
    return run_on_console(a.console, [&](Progress& progress) {
        slicer::StackJobResult result = slicer::run_stack_predict(a.job, progress);
        return CommandResult{std::move(result.json), std::move(result.text)};
    });
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
    command->add_flag("--check", job.check, "Monte Carlo of the whole stack beside it");
    command->add_option("--resins", job.resins, "resin set or file; empty: that of the stack file, else vero-opaque")
        ->type_name("SET|FILE");
    command
        ->add_option("--surface", job.surface, "on top: air, matched, auto; empty: as the stack file says, else auto")
        ->type_name("WHAT");
    command
        ->add_option("--backing", job.backing,
                     "below: black, white, air, or a profile file; empty: as the stack file says, else black")
        ->type_name("WHAT");
    command->add_option("--reach", arguments->reach, "radius of the disc that coefficients belong to")
        ->type_name("LENGTH")
        ->capture_default_str();
    command->add_option("--coefficients", job.coefficients, "per channel; detail is reach / N")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--paths", job.paths, "per traced layer or stack, and channel")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--seed", job.seed, "seed of traced light")->type_name("N")->capture_default_str();
    add_threads_option(*command, arguments->threads);
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
