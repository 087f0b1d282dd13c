// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps of `voxtone calibrate`, one file each, as the verbs in commands.h.
#pragma once

#include "voxtone/cli/commands.h"

namespace voxtone::cli {

Command add_calibrate_target_command(CLI::App& calibrate);
Command add_calibrate_simulate_command(CLI::App& calibrate);
Command add_calibrate_photo_command(CLI::App& calibrate);
Command add_calibrate_fit_command(CLI::App& calibrate);
Command add_calibrate_check_command(CLI::App& calibrate);
Command add_calibrate_profile_command(CLI::App& calibrate);
Command add_calibrate_simulate_profile_command(CLI::App& calibrate);

}  // namespace voxtone::cli
