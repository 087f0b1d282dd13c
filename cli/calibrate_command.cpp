// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "voxtone/cli/calibrate_commands.h"
#include "voxtone/cli/calibrate_program.h"
#include "voxtone/cli/commands.h"
#include "voxtone/cli/steps.h"

namespace voxtone::cli {

Command add_calibrate_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("calibrate", calibrate_description);
    return add_steps(*command, {add_calibrate_check_command, add_calibrate_fit_command, add_calibrate_photo_command,
                                add_calibrate_profile_command, add_calibrate_simulate_command,
                                add_calibrate_simulate_profile_command, add_calibrate_target_command});
}

}  // namespace voxtone::cli
