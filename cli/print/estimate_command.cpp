// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "cli/program/help.h"
#include "slicer/estimate/estimate_job.h"
#include "slicer/estimate/estimate_text.h"

namespace voxtone::cli {

namespace {

struct EstimateArguments {
    JobArguments job;
    slicer::EstimateScope scope;
    bool quick = false;
    ConsoleOptions console;
};

int run(const EstimateArguments& arguments) {
    const slicer::SliceOptions options = options_of(arguments.job);
    slicer::EstimateScope scope = arguments.scope;
    scope.resins = !arguments.quick;
    return run_on_console(arguments.console, [&](Progress& progress) {
        const slicer::JobEstimate estimate = slicer::estimate_job(options, progress, scope);
        return JobResult{slicer::estimate_json(estimate), slicer::estimate_text(estimate)};
    });
}

}  // namespace

Command add_estimate_command(CLI::App& program) {
    auto arguments = std::make_shared<EstimateArguments>();
    CLI::App* command = program.add_subcommand(
        "estimate", "Say what slicing would take, without doing it: size, layers, resins, time, memory, disk");
    add_job_options(*command, arguments->job);
    command
        ->add_flag(
            "--orientations", arguments->scope.orientations,
            "add a table of the 24 ways to turn the body by right angles: height, layers, what hangs over, which "
            "coloured faces lie downward")
        ->group("Run");
    command
        ->add_flag("--quick", arguments->quick,
                   "leave out how much of each resin: colours are not separated, which takes most of the time")
        ->group("Run");
    add_console_options(*command, arguments->console);
    add_example(*command, "cow.obj --size 60mm");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli
