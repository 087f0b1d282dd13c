// SPDX-License-Identifier: GPL-3.0-or-later
//
// The life of a job of a batch, as its state on disk tells it, whoever works on it: a process of a local batch
// (queued_job.h) or a task on a cluster (cluster/cluster_task.h).
//
//   queued -> running -> done
//                     -> failed     for a person to mend, or tried often enough
//                     -> queued     to be tried again, or stopped on request
#pragma once

#include <string>

#include "farm/batch/job_ending.h"
#include "farm/batch/job_state.h"

namespace voxtone::farm {

/// What an attempt's end asks for.
struct NextStep {
    enum class Kind {
        finish,     ///< its stack is to be taken
        again,      ///< the same another time
        with_more,  ///< another time, with more memory
        put_aside,  ///< it was stopped on request: who asked goes on with it another time
        fail,
        fail_with_stack,  ///< its stack is to be taken, and it has failed all the same
    };
    Kind kind = Kind::finish;
    int exit_code = 0;
    std::string message;
};

/// What is allowed to those who work on a job, and what was done so far.
struct Attempts {
    int made = 1;  ///< this one included
    int retries = 5;
    bool stopping = false;      ///< who works on jobs was asked to stop
    bool can_get_more = false;  ///< more memory may be asked for, and was not yet
    int got_on = 0;             ///< of those made: after which the loop had come further than before
};

[[nodiscard]] NextStep next_step(const JobEnding& ending, const Attempts& attempts);

/// Another attempt begins, on so many threads (0: not known); what the last one left is forgotten.
void note_start(JobState& state, const JobRunner& runner, int attempt, int threads);
/// Its stack is there, and `state` has its figures.
void note_done(JobState& state);
void note_failed(JobState& state, int exit_code, const std::string& message);
/// It waits for another attempt.
void note_waiting(JobState& state, int exit_code, const std::string& message);

}  // namespace voxtone::farm
