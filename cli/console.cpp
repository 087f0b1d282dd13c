// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/cli/console.h"

#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "voxtone/base/cancel_on_signal.h"
#include "voxtone/base/progress_bar.h"
#include "voxtone/base/progress_events.h"

namespace voxtone::cli {

namespace {

CommandResult run_with_events(const std::function<CommandResult(Progress&)>& work) {
    ProgressEvents events(stdout_sink(), steady_seconds());
    const CancelOnSignal cancel_on_signal(events);
    try {
        CommandResult result = work(events);
        events.result(result.json);
        return result;
    } catch (const Error& error) {
        events.error(error);
        throw;
    }
}

CommandResult run_with_text(bool quiet, const std::function<CommandResult(Progress&)>& work) {
    const std::unique_ptr<Progress> progress = make_console_progress(quiet);
    const CancelOnSignal cancel_on_signal(*progress);
    CommandResult result = work(*progress);
    fmt::print("{}", result.text);
    if (!result.text.empty() && result.text.back() != '\n') fmt::print("\n");
    return result;
}

}  // namespace

void add_console_options(CLI::App& command, ConsoleOptions& options) {
    command.add_flag("--json", options.json, "events and the result as one JSON object a line on stdout")->group("Run");
    command.add_flag("--quiet", options.quiet, "no progress, warnings only")->group("Run");
}

void add_threads_option(CLI::App& command, int& threads) {
    command.add_option("--threads", threads, "threads; 0: one per core. The result does not depend on it")
        ->group("Run")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
}

int run_on_console(const ConsoleOptions& options, const std::function<CommandResult(Progress&)>& work) {
    const CommandResult result = options.json ? run_with_events(work) : run_with_text(options.quiet, work);
    return static_cast<int>(result.exit_code);
}

}  // namespace voxtone::cli
