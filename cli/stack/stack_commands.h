// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone stack` and its steps, one file each.
#pragma once

#include "cli/program/command.h"

namespace voxtone::cli {

Command add_stack_command(CLI::App& program);

Command add_stack_dataset_command(CLI::App& stack);
Command add_stack_factor_command(CLI::App& stack);
Command add_stack_predict_command(CLI::App& stack);
Command add_stack_print_command(CLI::App& stack);
Command add_stack_search_command(CLI::App& stack);
Command add_stack_targets_command(CLI::App& stack);

}  // namespace voxtone::cli
