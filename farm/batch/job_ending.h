// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the end of a job's process means for the job.
#pragma once

#include <cstdint>
#include <string>

#include "farm/batch/job_process.h"

namespace voxtone::farm {

struct JobEnding {
    enum class Kind {
        done,
        again,    ///< for no fault of its own, or to be saved: the same again may go
        failed,   ///< for a person to mend
        checked,  ///< failed, and its stack and report are there: the print will not look as asked (--strict)
        starved,  ///< the kernel killed it, or what it had started, for memory: the same again with no more will not go
    };
    Kind kind = Kind::done;
    int exit_code = 0;    ///< of the program, or what stands for a signal
    std::string message;  ///< why it is not done
};

/// `said`: the last message of the process; empty: none. `was_asked`: it was told to stop by who asks here.
/// `oom_kills`: how often the kernel killed for memory in our control group while it ran (base/control_group.h), which
/// may have been another's doing: a job that held less than half of the `given_bytes` that were set aside for it was
/// not what took too much. 0: it is alone in its group.
[[nodiscard]] JobEnding ending_of(const ProcessEnd& end, const std::string& said, bool was_asked,
                                  std::uint64_t oom_kills = 0, std::uint64_t given_bytes = 0);

}  // namespace voxtone::farm
