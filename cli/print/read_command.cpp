// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/console.h"
#include "cli/program/help.h"
#include "slicer/prepare/contents_text.h"
#include "slicer/prepare/model_contents.h"

namespace voxtone::cli {

namespace {

struct ReadArguments {
    JobArguments job;
    ConsoleOptions console;
};

/// What is read of one file does not depend on the others: all are told of before the verb fails.
JobResult run(const ReadArguments& arguments, Progress& progress) {
    slicer::SliceOptions options = options_of(arguments.job);
    options.out = ".";      // nothing is written
    options.named.clear();  // among files of several kinds each takes what is its own
    tell_notes(options, progress);
    std::vector<slicer::ModelContents> files;
    for (const std::string& file : arguments.job.models) {
        options.model = file;
        files.push_back(slicer::read_contents(options, progress));
    }
    const auto failed = std::ranges::find_if(files, [](const auto& of) { return !of.error.empty(); });
    return {slicer::contents_json(files), slicer::contents_text(files),
            failed == files.end() ? ExitCode::done : failed->exit_code};
}

}  // namespace

Command add_read_command(CLI::App& program) {
    auto arguments = std::make_shared<ReadArguments>();
    CLI::App* command = program.add_subcommand(
        "read",
        "Say what is in models and pictures: format, unit, size, parts, triangles, textures, colours, materials, and "
        "the warnings that reading them gives. Nothing else is done; a file that cannot be read does not keep the "
        "others from being told");
    arguments->job.takes_many = true;
    add_some_job_options(*command, arguments->job,
                         {"model", "printer", "unit", "size", "scale", "width", "height", "dpi", "thickness", "rotate",
                          "texture", "read-memory", "read-time", "read-size", "read-pixels"});
    command->get_option("model")->required();
    add_console_options(*command, arguments->console);
    add_example(*command, "cow.obj logo.png");
    return [arguments] {
        return run_on_console(arguments->console, [&](Progress& progress) { return run(*arguments, progress); });
    };
}

}  // namespace voxtone::cli
