// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/batch/batch_commands.h"
#include "cli/program/console.h"
#include "cli/program/help.h"
#include "farm/batch/batch_status.h"
#include "farm/cluster/held_jobs.h"

namespace voxtone::cli {

Command add_status_command(CLI::App& program) {
    struct Arguments {
        std::string out;
        ConsoleOptions console;
    };
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = program.add_subcommand("status", "Say how far a batch is, while it runs or after");
    command->add_option("batch", arguments->out, "folder of the batch")->required()->type_name("FOLDER");
    arguments->console.answers = true;
    add_console_options(*command, arguments->console);
    add_example(*command, "out/monday");
    return [arguments] {
        return run_on_console(arguments->console, [&](Progress&) {
            return farm::batch_status(arguments->out, farm::held_jobs(arguments->out));
        });
    };
}

}  // namespace voxtone::cli
