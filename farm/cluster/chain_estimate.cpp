// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/chain_estimate.h"

#include <optional>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "farm/batch/job_result.h"
#include "farm/cluster/job_record.h"
#include "io/files/file_digest.h"
#include "io/programs/build_identity.h"
#include "slicer/print/run_print.h"

namespace voxtone::farm {

bool is_done(const BatchFolder& batch, const PlannedJob& job, const Progress& progress) {
    const std::optional<JobState> known = batch.state_of(job.name);
    if (!known) return false;
    for (const auto& [file, digest] : known->inputs) io::file_digests().learn(file, digest);
    return known->phase == JobPhase::done && known->program == io::build_identity() &&
           holds_job(job.out, job, &progress);
}

ChainEstimate estimate_chain(const PlannedJob& job, const ChainOptions& options, Progress& progress) {
    slicer::SliceOptions requested = options_on_cluster(job.options);
    if (requested.threads == 0) requested.threads = options.most_cores;
    ChainEstimate made;
    try {
        const slicer::JobEstimate estimate = slicer::estimate_print({requested}, progress);
        if (!estimate.faults.empty())
            throw Error(estimate.exit_code, fmt::format("shards of a tray leave no part out, and these fail:\n  {}",
                                                        fmt::join(estimate.faults, "\n  ")));
        made.chain = task_chain(job, estimate, options);
        if (!made.chain.why_whole.empty()) made.message = fmt::format("it cannot be cut: {}", made.chain.why_whole);
    } catch (const Cancelled&) {
        throw;
    } catch (const TryAgain&) {
        throw;
    } catch (const Error& error) {
        made.message = error.what();
        made.exit_code = static_cast<int>(error.exit_code());
    }
    return made;
}

JobState state_to_hand_over(const BatchFolder& batch, const PlannedJob& job, std::size_t number) {
    JobState state = batch.state_of(job.name).value_or(JobState());
    state.name = job.name;
    state.number = number;
    state.command = job.command;
    if (!state.folder_is_ours) state.folder_is_ours = is_missing_or_empty(job.out);
    state.runner.reset();
    state.finished.clear();
    state.figures.reset();
    state.after.reset();
    state.exit_code = 0;
    state.threads = 0;
    state.expected_cpu_s = 0;
    return state;
}

void note_failure(const BatchFolder& batch, const PlannedJob& job, std::size_t number, const ChainEstimate& estimate,
                  Progress& progress) {
    change_state(batch, job.name, progress, [&](JobState& state) {
        state = state_to_hand_over(batch, job, number);
        state.phase = JobPhase::failed;
        state.exit_code = estimate.exit_code;
        state.message = estimate.message;
        state.finished = utc_now();
    });
}

}  // namespace voxtone::farm
