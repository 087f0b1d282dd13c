// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_life.h"

#include <fmt/core.h>

#include "base/error.h"
#include "io/programs/build_identity.h"

namespace voxtone::farm {

namespace {

using StepKind = NextStep::Kind;

void note_end(JobState& state, JobPhase phase, int exit_code, const std::string& message) {
    state.phase = phase;
    state.runner.reset();
    state.exit_code = exit_code;
    state.message = message;
}

NextStep another_time(const JobEnding& ending, const Attempts& attempts) {
    if (attempts.stopping) return {StepKind::put_aside, ending.exit_code, ending.message};
    // One that got on costs no other one: with its time cut short a loop is done all the same.
    if (attempts.made - attempts.got_on > attempts.retries)
        return {StepKind::fail, ending.exit_code,
                attempts.got_on > 0 ? fmt::format("{} (after {} attempts, of which {} came further)", ending.message,
                                                  attempts.made, attempts.got_on)
                                    : fmt::format("{} (after {} attempts)", ending.message, attempts.made)};
    return {StepKind::again, ending.exit_code, ending.message};
}

}  // namespace

NextStep next_step(const JobEnding& ending, const Attempts& attempts) {
    switch (ending.kind) {
        case JobEnding::Kind::done:
            return {};
        case JobEnding::Kind::again:
            return another_time(ending, attempts);
        case JobEnding::Kind::starved: {
            if (!attempts.can_get_more) return {StepKind::fail, ending.exit_code, ending.message};
            NextStep step = another_time(ending, attempts);
            if (step.kind == StepKind::again) step.kind = StepKind::with_more;
            return step;
        }
        case JobEnding::Kind::checked:
            return {StepKind::fail_with_stack, ending.exit_code, ending.message};
        case JobEnding::Kind::failed:
            break;
    }
    return {StepKind::fail, ending.exit_code, ending.message};
}

void note_start(JobState& state, const JobRunner& runner, int attempt, int threads) {
    state.phase = JobPhase::running;
    state.runner = runner;
    state.program = io::build_identity();
    state.attempts = attempt;
    if (attempt <= 1) state.attempts_that_got_on = 0;
    state.threads = threads;
    state.message.clear();
    state.finished.clear();
    state.figures.reset();
    state.after.reset();
}

void note_done(JobState& state) {
    note_end(state, JobPhase::done, 0, {});
    state.program = io::build_identity();
    state.finished = utc_now();
}

void note_failed(JobState& state, int exit_code, const std::string& message) {
    note_end(state, JobPhase::failed, exit_code, message);
    state.finished = utc_now();
}

void note_waiting(JobState& state, int exit_code, const std::string& message) {
    note_end(state, JobPhase::queued, exit_code, message);
}

}  // namespace voxtone::farm
