// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/stack_commands.h"
#include "voxtone/slicer/stacks/stack_print_job.h"

namespace voxtone::cli {

namespace {

struct StackPrintArguments {
    slicer::StackPrintJob job;
    std::string width = "20mm", depth = "20mm", gap = "5mm";
    int threads = 0;
    ConsoleOptions console;
};

int run(StackPrintArguments& a) {
    a.job.width_mm = parse_length_mm(a.width, "--width");
    a.job.depth_mm = parse_length_mm(a.depth, "--depth");
    a.job.gap_mm = parse_length_mm(a.gap, "--gap");
    const ThreadLimit limit(static_cast<std::size_t>(a.threads));
    return run_on_console(a.console, [&](Progress& progress) {
        slicer::StackJobResult result = slicer::run_stack_print(a.job, progress);
        return CommandResult{std::move(result.json), std::move(result.text)};
    });
}

}  // namespace

Command add_stack_print_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackPrintArguments>();
    slicer::StackPrintJob& job = arguments->job;
    CLI::App* command = stack.add_subcommand("print", "Make printable slabs of stacks of layers, side by side");
    command
        ->add_option("stacks", job.stacks, "stack files (voxtone-stack), or layers: \"W 0.3, K 0.1\" (mm, top first)")
        ->type_name("FILE|LAYERS")
        ->required();
    command->add_option("-o,--out", job.out, "output folder")->type_name("FOLDER")->required();
    command->add_flag("--overwrite", job.overwrite, "write into a folder that holds other things");
    command->add_option("--printer", job.printer, "printer (`voxtone list printers`) or file of its profile")
        ->type_name("ID|FILE")
        ->capture_default_str();
    command->add_option("--resins", job.resins, "resin set or file; empty: that of the stack file, else vero-opaque")
        ->type_name("SET|FILE");
    const auto length = [&](const char* name, std::string& value, const char* help) {
        command->add_option(name, value, help)->type_name("LENGTH")->capture_default_str();
    };
    length("--width", arguments->width, "of a slab, along x");
    length("--depth", arguments->depth, "of a slab, along y");
    length("--gap", arguments->gap, "between slabs");
    command
        ->add_option("--base", job.base,
                     "a layer below each slab, such as K=1mm: stacks searched on black lie on black then; empty: none")
        ->type_name("ROLE=LENGTH");
    command->add_flag("--gcvf", job.outputs.gcvf, "write a GCVF container too");
    add_threads_option(*command, arguments->threads);
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
