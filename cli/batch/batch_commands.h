// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs of many prints.
#pragma once

#include "cli/program/command.h"

namespace voxtone::cli {

Command add_batch_command(CLI::App& program);
Command add_status_command(CLI::App& program);
Command add_task_command(CLI::App& program);
Command add_serve_command(CLI::App& program);

}  // namespace voxtone::cli
