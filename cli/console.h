// SPDX-License-Identifier: GPL-3.0-or-later
//
// What every verb shares at the terminal: --json, --quiet, progress on stderr (or events on stdout), one result on
// stdout, and a clean stop on Ctrl-C.
#pragma once

#include <functional>
#include <string>

#include "voxtone/base/progress.h"

namespace CLI {
class App;
}

namespace voxtone::cli {

struct ConsoleOptions {
    bool json = false;
    bool quiet = false;
};

void add_console_options(CLI::App& command, ConsoleOptions& options);
/// `--threads`, [0, 1024].
void add_threads_option(CLI::App& command, int& threads);

/// What a verb has to say at its end.
struct CommandResult {
    std::string json;  ///< with --json
    std::string text;  ///< without
    ExitCode exit_code = ExitCode::done;
};

/// Runs the work under the chosen kind of progress and prints its result. Errors pass through, after an event that
/// tells them with --json.
int run_on_console(const ConsoleOptions& options, const std::function<CommandResult(Progress&)>& work);

}  // namespace voxtone::cli
