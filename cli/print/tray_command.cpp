// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "cli/program/outcome.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_values.h"

namespace voxtone::cli {

namespace {

struct TrayArguments {
    JobArguments job;
    ConsoleOptions console;
};

int run(const TrayArguments& arguments) {
    const slicer::SliceOptions options = options_of(arguments.job);
    if (arguments.job.dump_default) {
        print_out(slicer::job_json(options));
        return 0;
    }
    return run_on_console(arguments.console, [&](Progress& progress) {
        slicer::TrayModels models = many_models(arguments.job, options);
        // One model is a tray of one part.
        if (models.empty() && !slicer::is_tray(options) && !options.model.empty()) models.files = {options.model};
        return run_tray(options, models, progress);
    });
}

}  // namespace

Verb tray_verb() {
    auto arguments = std::make_shared<TrayArguments>();
    Verb command(
        "tray",
        "Slice many parts, and copies of them, into one print: what `slice` does with several models or a plan, whose "
        "parts may also be boxes, cylinders, finished stacks and jobs",
        "tray.json -o out/tray");
    arguments->job.takes_many = true;
    add_job_options(command, arguments->job, {"layers", "mixtures", "resume"});
    add_dump_default(command, arguments->job);
    add_console_options(command, arguments->console);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
