// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "cli/laminate/laminate_commands.h"
#include "cli/program/command.h"
#include "cli/program/help.h"
#include "cli/program/steps.h"

namespace voxtone::cli {

Command add_laminate_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("laminate", "Laminates that show how light is wanted to spread in a surface");
    add_example(*command, "search wanted.json --materials W,K -o found");
    return add_steps(*command, {add_laminate_dataset_command, add_laminate_factor_command, add_laminate_predict_command,
                                add_laminate_print_command, add_laminate_search_command, add_laminate_targets_command});
}

}  // namespace voxtone::cli
