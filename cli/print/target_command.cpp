// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "slicer/print/marker_print.h"

namespace voxtone::cli {

namespace {

struct MarkerArguments {
    slicer::MarkerJob job;
    RunOptions run;
};

Verb marker_verb() {
    auto arguments = std::make_shared<MarkerArguments>();
    slicer::MarkerJob& job = arguments->job;
    Verb command(
        "marker",
        "Make the marker to print before anything else on a machine: a look tells whether prints come out mirrored or "
        "turned, which side was up, and whether each resin is where it was meant",
        "-o out/marker");
    add_printer_option(command, job.printer);
    command.add("--load", job.roles, "roles of the loaded resins: C,M,Y,K,W; the printer's default where none is said",
                {.unit = "ROLES", .one_each = true, .separator = ','});
    add_stack_folder_options(command, job.out, job.overwrite);
    command.add("--gcvf", job.outputs.gcvf, "write a GCVF container too");
    add_run_options(command, arguments->run);
    command.run = [arguments] {
        return run_on_console(arguments->run,
                              [&](Progress& progress) { return slicer::run_marker_job(arguments->job, progress); });
    };
    return command;
}

}  // namespace

Verb target_verb() {
    Verb command("target", "Prints that tell about a machine before it prints for others", "marker -o out/marker");
    command.steps = {marker_verb()};
    return command;
}

}  // namespace voxtone::cli
