// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/commands.h"
#include "voxtone/cli/steps.h"

namespace voxtone::cli {

Command add_calibrate_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("calibrate",
                               "Find the resins' albedo and extinction from one printed and photographed (or measured) "
                               "target, or measure how light spreads in a slab");
    return add_steps(*command, {add_calibrate_check_command, add_calibrate_fit_command, add_calibrate_photo_command,
                                add_calibrate_profile_command, add_calibrate_simulate_command,
                                add_calibrate_simulate_profile_command, add_calibrate_target_command});
}

}  // namespace voxtone::cli
