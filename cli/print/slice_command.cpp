// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "cli/program/outcome.h"
#include "slicer/job/slice_job.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_values.h"
#include "slicer/shards/shard_job.h"

namespace voxtone::cli {

namespace {

struct SliceArguments {
    JobArguments job;
    ConsoleOptions console;
};

void add_options(Verb& command, SliceArguments& arguments) {
    arguments.job.takes_many = true;
    add_job_options(command, arguments.job);
    add_dump_default(command, arguments.job);
    add_console_options(command, arguments.console);
}

int run(const SliceArguments& arguments) {
    const slicer::SliceOptions options = options_of(arguments.job);
    if (arguments.job.dump_default) {
        print_out(slicer::job_json(options));
        return 0;
    }
    return run_on_console(arguments.console, [&](Progress& progress) {
        const slicer::TrayModels many = many_models(arguments.job, options);
        if (many.files.size() > 1)
            progress.note(fmt::format("{} models become the parts of one tray; `voxtone batch` makes a job of each",
                                      many.files.size()));
        if (!many.empty() || slicer::is_tray(options)) return run_tray(options, many, progress);
        if (!options.shard.empty()) return slicer::run_shard_job(options, progress);
        slicer::SliceResult result = slicer::run_slice_job(options, progress);
        return JobResult{std::move(result.json), std::move(result.summary), result.exit_code};
    });
}

}  // namespace

Verb slice_verb() {
    auto arguments = std::make_shared<SliceArguments>();
    Verb command("slice", "Slice a textured mesh or a picture, or many of them, into a printable layer stack",
                 "cow.obj --size 60mm -o out/cow");
    add_options(command, *arguments);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli
