// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program/console.h"

#include <chrono>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "base/cancel_on_signal.h"
#include "base/openjd_progress.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "base/progress_bar.h"
#include "base/progress_events.h"
#include "base/stop_deadline.h"
#include "cli/program/outcome.h"
#include "cli/program/verb.h"

namespace voxtone::cli {

namespace {

/// How a stop is told: why, and how to go on.
Error stopped() {
    const bool again = stop_code() == ExitCode::stopped;
    const std::string why = again ? "stopped on request" : "cancelled", advice = stop_advice();
    return {again ? ExitCode::stopped : ExitCode::unfinished,
            !advice.empty() ? why + "; " + advice
            : again         ? why + "; nothing of it is saved yet: run the same command again, which begins anew"
                            : why};
}

/// Ends within the grace of a request to stop, also where the work does not look at it.
JobResult work_until_stopped(const std::function<JobResult(Progress&)>& work, Progress& progress, Messages messages,
                             std::chrono::milliseconds grace) {
    const CancelOnSignal cancel_on_signal(progress);
    const StopDeadline deadline(progress, grace,
                                [messages] { return guarded(messages, []() -> int { throw stopped(); }); });
    try {
        return work(progress);
    } catch (const Cancelled&) {
        throw stopped();
    }
}

/// Warnings and the result alone.
TextSink quiet_sink(TextSink sink) {
    return [sink = std::move(sink)](std::string_view line) {
        for (const std::string_view event : {"progress", "stage", "note"})
            if (line.starts_with(fmt::format(R"({{"event":"{}")", event))) return;
        sink(line);
    };
}

JobResult run_with_events(const ConsoleOptions& options, const std::function<JobResult(Progress&)>& work) {
    ProgressEvents events(options.quiet ? quiet_sink(stdout_sink()) : stdout_sink(), steady_seconds(), true);
    JobResult result = work_until_stopped(work, events, Messages::events, options.grace);
    events.result(result.json);
    return result;
}

void print_lines(const std::string& text) {
    print_out(printable(text));
    if (!text.empty() && text.back() != '\n') print_out("\n");
}

JobResult run_with_text(const ConsoleOptions& options, const std::function<JobResult(Progress&)>& work) {
    const std::unique_ptr<Progress> progress = make_console_progress(options.quiet);
    JobResult result = work_until_stopped(work, *progress, Messages::text, options.grace);
    const bool failed = result.exit_code != ExitCode::done;
    if (!options.quiet || options.answers)
        print_lines(result.text);
    else if (failed)
        print_lines(result.failure.value_or(result.text));
    return result;
}

JobResult run_for_openjd(const std::function<JobResult(Progress&)>& work, std::chrono::milliseconds grace) {
    OpenJobProgress progress(stdout_sink(), steady_seconds(), true);
    JobResult result = work_until_stopped(work, progress, Messages::openjd, grace);
    print_lines(result.text);
    if (result.exit_code == ExitCode::done)
        progress.finish();
    else
        print_out(openjd_failure(fmt::format("ended with exit code {}; what it says of that stands before this line",
                                             static_cast<int>(result.exit_code))) +
                  "\n");
    return result;
}

}  // namespace

void add_console_options(Verb& verb, ConsoleOptions& options) {
    verb.group("Run");
    verb.add("--json", options.json, "events and the result as one JSON object a line on stdout",
             {.not_with = "--progress"});
    verb.add("--progress", options.progress,
             "auto: a bar on a terminal, lines elsewhere; openjd: the messages of Open Job Description on stdout "
             "(openjd_status, openjd_progress, openjd_fail), one at least every 10 s",
             {.unit = "KIND", .choices = {"auto", "openjd"}});
    verb.add("--quiet", options.quiet,
             options.answers ? "the answer, warnings and errors: no progress"
                             : "warnings and errors: no progress, and no summary of what is done");
}

int run_on_console(const ConsoleOptions& options, const std::function<JobResult(Progress&)>& work) {
    const JobResult result = options.json       ? run_with_events(options, work)
                             : options.openjd() ? run_for_openjd(work, options.grace)
                                                : run_with_text(options, work);
    return static_cast<int>(result.exit_code);
}

int run_on_console(const ConsoleOptions& options, int threads, const std::function<JobResult(Progress&)>& work) {
    const ThreadLimit limit(static_cast<std::size_t>(threads));
    return run_on_console(options, work);
}

}  // namespace voxtone::cli
