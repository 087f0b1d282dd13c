// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include "cli/batch/batch_commands.h"
#include "cli/program/console.h"
#include "farm/batch/batch_status.h"
#include "farm/cluster/held_jobs.h"

namespace voxtone::cli {

Verb status_verb() {
    struct Arguments {
        std::string out;
        ConsoleOptions console;
    };
    auto arguments = std::make_shared<Arguments>();
    Verb command("status", "Say how far a batch is, while it runs or after", "out/monday");
    command.add("batch", arguments->out, "folder of the batch", {.unit = "FOLDER", .required = true});
    arguments->console.answers = true;
    add_console_options(command, arguments->console);
    command.run = [arguments] {
        return run_on_console(arguments->console, [&](Progress&) {
            return farm::batch_status(arguments->out, farm::held_jobs(arguments->out));
        });
    };
    return command;
}

}  // namespace voxtone::cli
