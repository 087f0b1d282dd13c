// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "cli/program/command.h"
#include "cli/program/help.h"
#include "cli/program/steps.h"
#include "cli/stack/stack_commands.h"

namespace voxtone::cli {

Command add_stack_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("stack", "Stacks of layers that show how light is wanted to spread in a surface");
    add_example(*command, "search wanted.json --materials W,K -o found");
    return add_steps(*command, {add_stack_dataset_command, add_stack_factor_command, add_stack_predict_command,
                                add_stack_print_command, add_stack_search_command, add_stack_targets_command});
}

}  // namespace voxtone::cli
