// SPDX-License-Identifier: GPL-3.0-or-later
//
// What every verb shares at the terminal: --json, --quiet, --progress, progress on stderr (or events on stdout), one
// result on stdout, and a clean stop on Ctrl-C.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"

namespace voxtone::cli {

class Verb;

struct ConsoleOptions {
    bool json = false;
    bool quiet = false;
    bool answers = false;                  ///< its text is what the verb is asked for: --quiet leaves it
    std::string progress = "auto";         ///< or openjd: messages of Open Job Description
    std::chrono::milliseconds grace{800};  ///< that a verb has to end after a request to stop
    [[nodiscard]] bool openjd() const { return progress == "openjd"; }
};

/// --json, --progress, --quiet.
void add_console_options(Verb& verb, ConsoleOptions& options);

/// Runs the work under the chosen kind of progress and prints its result. Errors pass through.
int run_on_console(const ConsoleOptions& options, const std::function<JobResult(Progress&)>& work);
/// The same on this many threads; 0: one per core.
int run_on_console(const ConsoleOptions& options, int threads, const std::function<JobResult(Progress&)>& work);

}  // namespace voxtone::cli
