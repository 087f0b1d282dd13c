// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/stack_commands.h"
#include "voxtone/slicer/stacks/stack_targets_job.h"

namespace voxtone::cli {

namespace {

struct StackTargetsArguments {
    slicer::StackTargetsJob job;
    std::string reach = "10mm";
    int threads = 0;
    ConsoleOptions console;
};

int run(StackTargetsArguments& a) {
    a.job.stack.reach_mm = parse_length_mm(a.reach, "--reach");
    const ThreadLimit limit(static_cast<std::size_t>(a.threads));
    return run_on_console(a.console, [&](Progress& progress) {
        slicer::StackJobResult result = slicer::run_stack_targets(a.job, progress);
        return CommandResult{std::move(result.json), std::move(result.text)};
    });
}

}  // namespace

Command add_stack_targets_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackTargetsArguments>();
    slicer::StackTargetsJob& job = arguments->job;
    CLI::App* command =
        stack.add_subcommand("targets", "Make targets of one albedo and rising width, between two stacks");
    command
        ->add_option("narrow", job.narrow,
                     "where light spreads least: a stack file, or layers: \"W 5\" (mm, top first)")
        ->type_name("FILE|LAYERS")
        ->required();
    command->add_option("wide", job.wide, "where light spreads most: \"W 0.2, T 4.8\"")
        ->type_name("FILE|LAYERS")
        ->required();
    command->add_option("-o,--out", job.out, "folder for target-1.json (narrowest), target-2.json, ... and targets.svg")
        ->type_name("FOLDER")
        ->required();
    command->add_flag("--overwrite", job.overwrite, "replace files of the same names in the folder");
    command->add_option("--count", job.count, "targets, from 1 to 1000")->type_name("N")->capture_default_str();
    command
        ->add_option("--resins", job.stack.resins, "resin set or file; empty: that of the stack file, else vero-opaque")
        ->type_name("SET|FILE");
    command
        ->add_option("--surface", job.stack.surface,
                     "on top: air, matched, auto; empty: as the stack file says, else auto")
        ->type_name("WHAT");
    command
        ->add_option("--backing", job.stack.backing,
                     "below: black, white, air, or a profile file; empty: as the stack file says, else black")
        ->type_name("WHAT");
    command
        ->add_option("--reach", arguments->reach, "radius of the disc that coefficients belong to, and of the profiles")
        ->type_name("LENGTH")
        ->capture_default_str();
    command->add_option("--coefficients", job.stack.coefficients, "per channel, from 4 to 1024; detail is reach / N")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--paths", job.paths, "per stack and channel")->type_name("N")->capture_default_str();
    command->add_option("--seed", job.seed, "seed of traced light")->type_name("N")->capture_default_str();
    add_threads_option(*command, arguments->threads);
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
