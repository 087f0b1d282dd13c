// SPDX-License-Identifier: GPL-3.0-or-later
//
// Requests to stop that come as signals. SIGINT is a user who wants an end (Ctrl-C, exit code 5); SIGTERM,
// SIGUSR1 and SIGHUP (a terminal or a connection that is gone) come from what runs the program, which wants it saved to
// run it again (exit code 85). The first of them asks the work to stop (`Progress::cancel`), so that no half-written
// file is left; a Ctrl-C after it ends the program at once, more of the others change nothing: schedulers send them
// twice. SIGPIPE ends nothing: hours of work do not depend on who reads its words; nor does SIGXFSZ: a file that must
// not grow further is an error with a sentence; and SIGCHLD is not ignored, even where it was by who started us, for
// then the system forgets how children ended.
#pragma once

#include "base/error.h"
#include "base/progress.h"

namespace voxtone {

/// From here on to the program's end; the first thing in `main`, so that no signal comes too early. One that comes
/// before there is work is kept for it. Signals that were ignored at the start (nohup) stay so.
void catch_stop_signals();

/// What the first signal that was caught asks for: unfinished (Ctrl-C) or ExitCode::stopped; done: none came.
[[nodiscard]] ExitCode stop_code();

/// While it lives the signals that were caught stop this work: also one that came before. One at a time in a program.
class CancelOnSignal {
public:
    explicit CancelOnSignal(Progress& progress);
    CancelOnSignal(const CancelOnSignal&) = delete;
    CancelOnSignal& operator=(const CancelOnSignal&) = delete;
    ~CancelOnSignal();
};

}  // namespace voxtone
