// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs of one print: made, foreseen, predicted, checked.
#pragma once

#include "cli/program/command.h"

namespace voxtone::cli {

Command add_slice_command(CLI::App& program);
Command add_tray_command(CLI::App& program);
Command add_estimate_command(CLI::App& program);
Command add_read_command(CLI::App& program);
Command add_merge_command(CLI::App& program);
Command add_predict_command(CLI::App& program);
Command add_proof_command(CLI::App& program);
Command add_target_command(CLI::App& program);
Command add_verify_command(CLI::App& program);
Command add_list_command(CLI::App& program);

}  // namespace voxtone::cli
