// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the end of a job's process means for the job.
#pragma once

#include <string>

#include "slicer/batch/job_process.h"

namespace voxtone::slicer {

struct JobEnding {
    enum class Kind {
        done,
        again,    ///< for no fault of its own, or to be saved: the same again may go
        failed,   ///< for a person to mend
        checked,  ///< failed, and its stack and report are there: the print will not look as asked (--strict)
    };
    Kind kind = Kind::done;
    int exit_code = 0;    ///< of the program, or what stands for a signal
    std::string message;  ///< why it is not done
};

/// `said`: the last message of the process; empty: none. `was_asked`: it was told to stop by who asks here.
[[nodiscard]] JobEnding ending_of(const ProcessEnd& end, const std::string& said, bool was_asked);

}  // namespace voxtone::slicer
