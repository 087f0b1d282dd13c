// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone slice`, and `voxtone tray`, which makes a tray of a lone model, too.
#include <memory>

#include <fmt/core.h>

#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "cli/program/outcome.h"
#include "slicer/options/job_file.h"
#include "slicer/print/run_print.h"

namespace voxtone::cli {

namespace {

struct SliceArguments {
    JobArguments job;
    ConsoleOptions console;
    bool of_tray = false;
};

int run(const SliceArguments& arguments) {
    const slicer::SliceOptions options = options_of(arguments.job);
    if (arguments.job.dump_default) {
        print_out(slicer::job_json(options));
        return 0;
    }
    return run_on_console(arguments.console, [&](Progress& progress) {
        const slicer::TrayModels many = many_models(arguments.job, options);
        if (many.files.size() > 1 && !arguments.of_tray)
            progress.note(fmt::format("{} models become the parts of one tray; `voxtone batch` makes a job of each",
                                      many.files.size()));
        return slicer::run_print({options, many, arguments.of_tray}, progress);
    });
}

Verb with_job(Verb command, bool of_tray, const std::vector<std::string>& without) {
    auto arguments = std::make_shared<SliceArguments>();
    arguments->of_tray = of_tray;
    arguments->job.takes_many = true;
    add_job_options(command, arguments->job, without);
    add_dump_default(command, arguments->job);
    add_console_options(command, arguments->console);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace

Verb slice_verb() {
    return with_job({"slice", "Slice a textured mesh or a picture, or many of them, into a printable layer stack",
                     "cow.obj --size 60mm -o out/cow"},
                    false, {});
}

Verb tray_verb() {
    return with_job(
        {"tray",
         "Slice many parts, and copies of them, into one print: what `slice` does with several models or a plan, whose "
         "parts may also be boxes, cylinders, finished stacks and jobs",
         "tray.json -o out/tray"},
        true, {"layers", "mixtures", "resume"});
}

}  // namespace voxtone::cli
