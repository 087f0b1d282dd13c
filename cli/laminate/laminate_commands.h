// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate` and its steps, one file each.
#pragma once

#include "cli/program/command.h"

namespace voxtone::cli {

Command add_laminate_command(CLI::App& program);

Command add_laminate_dataset_command(CLI::App& laminate);
Command add_laminate_factor_command(CLI::App& laminate);
Command add_laminate_predict_command(CLI::App& laminate);
Command add_laminate_print_command(CLI::App& laminate);
Command add_laminate_search_command(CLI::App& laminate);
Command add_laminate_targets_command(CLI::App& laminate);

}  // namespace voxtone::cli
