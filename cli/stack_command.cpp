// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "voxtone/base/error.h"
#include "voxtone/cli/commands.h"
#include "voxtone/cli/stack_commands.h"

namespace voxtone::cli {

Command add_stack_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("stack", "Stacks of layers that show how light is wanted to spread in a surface");
    command->require_subcommand(1);
    auto steps = std::make_shared<std::vector<std::pair<CLI::App*, Command>>>();
    const auto add = [&](const char* name, Command step) {
        steps->emplace_back(command->get_subcommand(name), std::move(step));
    };
    add("dataset", add_stack_dataset_command(*command));
    add("factor", add_stack_factor_command(*command));
    add("predict", add_stack_predict_command(*command));
    add("print", add_stack_print_command(*command));
    add("search", add_stack_search_command(*command));
    add("targets", add_stack_targets_command(*command));
    return [steps] {
        for (const auto& [step, run] : *steps)
            if (step->parsed()) return run();
        return static_cast<int>(ExitCode::usage);
    };
}

}  // namespace voxtone::cli
