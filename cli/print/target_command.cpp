// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"
#include "cli/program/steps.h"
#include "slicer/targets/marker_print.h"

namespace voxtone::cli {

namespace {

struct MarkerArguments {
    slicer::MarkerJob job;
    RunOptions run;
};

Command add_marker_command(CLI::App& target) {
    auto arguments = std::make_shared<MarkerArguments>();
    slicer::MarkerJob& job = arguments->job;
    CLI::App* command = target.add_subcommand(
        "marker",
        "Make the marker to print before anything else on a machine: a look tells whether prints come out mirrored or "
        "turned, which side was up, and whether each resin is where it was meant");
    add_printer_option(*command, job.printer);
    command
        ->add_option("--load", job.roles,
                     "roles of the loaded resins: C,M,Y,K,W; the printer's default where none is said")
        ->type_name("ROLES")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_stack_folder_options(*command, job.out, job.overwrite);
    command->add_flag("--gcvf", job.outputs.gcvf, "write a GCVF container too");
    add_run_options(*command, arguments->run);
    add_example(*command, "-o out/marker");
    return [arguments] {
        return run_on_console(arguments->run,
                              [&](Progress& progress) { return slicer::run_marker_job(arguments->job, progress); });
    };
}

}  // namespace

Command add_target_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("target", "Prints that tell about a machine before it prints for others");
    add_example(*command, "marker -o out/marker");
    return add_steps(*command, {add_marker_command});
}

}  // namespace voxtone::cli
