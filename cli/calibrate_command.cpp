// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "voxtone/base/error.h"
#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/calibrate_program.h"
#include "voxtone/cli/commands.h"

namespace voxtone::cli {

Command add_calibrate_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("calibrate", calibrate_description);
    command->require_subcommand(1);
    auto steps = std::make_shared<std::vector<std::pair<CLI::App*, Command>>>();
    const auto add = [&](const char* name, Command step) {
        steps->emplace_back(command->get_subcommand(name), std::move(step));
    };
    add("check", add_calibrate_check_command(*command));
    add("fit", add_calibrate_fit_command(*command));
    add("photo", add_calibrate_photo_command(*command));
    add("profile", add_calibrate_profile_command(*command));
    add("simulate", add_calibrate_simulate_command(*command));
    add("simulate-profile", add_calibrate_simulate_profile_command(*command));
    add("target", add_calibrate_target_command(*command));
    return [steps] {
        for (const auto& [step, run] : *steps)
            if (step->parsed()) return run();
        return static_cast<int>(ExitCode::usage);
    };
}

}  // namespace voxtone::cli
