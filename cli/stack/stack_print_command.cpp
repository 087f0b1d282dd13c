// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/program/help.h"
#include "cli/stack/stack_commands.h"
#include "cli/stack/stack_options.h"
#include "slicer/stacks/stack_print_job.h"

namespace voxtone::cli {

namespace {

struct StackPrintArguments {
    slicer::StackPrintJob job;
    RunOptions run;
};

int run(StackPrintArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return slicer::run_stack_print(a.job, progress); });
}

}  // namespace

Command add_stack_print_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackPrintArguments>();
    slicer::StackPrintJob& job = arguments->job;
    LengthOptions& lengths = arguments->run.lengths;
    CLI::App* command = stack.add_subcommand("print", "Make printable slabs of stacks of layers, side by side");
    command
        ->add_option("stacks", job.stacks, "stack files (voxtone-stack), or layers: \"W 0.3, K 0.1\" (mm, top first)")
        ->type_name("FILE|LAYERS")
        ->required();
    add_stack_folder_options(*command, job.out, job.overwrite);
    add_printer_option(*command, job.printer);
    add_stack_resins_option(*command, job.resins);
    lengths.add(*command, "--width", job.width_mm, "of a slab, along x");
    lengths.add(*command, "--depth", job.depth_mm, "of a slab, along y");
    lengths.add(*command, "--gap", job.gap_mm, "between slabs");
    command
        ->add_option("--base", job.base,
                     "a layer below each slab, such as K=1mm: stacks searched on black lie on black then; empty: none")
        ->type_name("ROLE=LENGTH");
    command->add_flag("--gcvf", job.outputs.gcvf, "write a GCVF container too");
    add_run_options(*command, arguments->run);
    add_example(*command, "\"W 0.3, K 0.1\" -o out/slab");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
