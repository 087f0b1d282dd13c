// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verbs of the program, one file each: parse, call, print. Each adds its sub-command and returns what to run when
// it was chosen; the number it gives back is the exit code.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace voxtone::cli {

using Command = std::function<int()>;

Command add_slice_command(CLI::App& program);
Command add_estimate_command(CLI::App& program);
Command add_merge_command(CLI::App& program);
Command add_predict_command(CLI::App& program);
Command add_batch_command(CLI::App& program);
Command add_status_command(CLI::App& program);
Command add_task_command(CLI::App& program);
Command add_verify_command(CLI::App& program);
Command add_stack_command(CLI::App& program);
Command add_list_command(CLI::App& program);

}  // namespace voxtone::cli
