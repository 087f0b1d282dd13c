// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stop that is asked for happens, whatever the work is doing. Ours looks many times a second whether it is still
// wanted and ends by itself; libraries look at no Progress, and a machine may be short of memory or time. Work that has
// not ended by itself within the grace is left where it stands: the program ends at once. That loses nothing that
// ending by itself would keep, as files are whole or not there (io/files/whole_file.h) and what took long is saved on
// the way (checkpoints); what is left under temporary names is the next job's to sweep, as after a crash.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "base/progress.h"

namespace voxtone {

class StopDeadline {
public:
    /// Once `grace` has passed after a request to stop, calls `leave` from a thread of its own: it says what there is
    /// to say and gives the exit code.
    StopDeadline(const Progress& progress, std::chrono::milliseconds grace, std::function<int()> leave);
    StopDeadline(const StopDeadline&) = delete;
    StopDeadline& operator=(const StopDeadline&) = delete;
    /// The work has ended by itself.
    ~StopDeadline();

private:
    std::atomic<bool> over_{false};
    std::thread watch_;
};

/// What somebody who stops the work now should know: how to go on with what is saved. Empty: nothing is saved.
void set_stop_advice(const std::string& advice);
[[nodiscard]] std::string stop_advice();

}  // namespace voxtone
