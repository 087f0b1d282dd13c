// SPDX-License-Identifier: GPL-3.0-or-later
//
// Jobs of a plan before they are handed to a scheduler: which are done, what the others take as tasks, and how that is
// noted in the batch's folder.
#pragma once

#include <cstddef>
#include <string>

#include "base/progress.h"
#include "farm/batch/batch_folder.h"
#include "farm/batch/plan.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

/// Whether the job was done and has not changed since.
[[nodiscard]] bool is_done(const BatchFolder& batch, const PlannedJob& job, const Progress& progress);

struct ChainEstimate {
    TaskChain chain;
    std::string message;  ///< why it failed, or why it cannot be cut though that was asked for; else empty
    int exit_code = 0;    ///< of a job that cannot be estimated, and so not be sliced
};

/// Throws Cancelled, TryAgain.
[[nodiscard]] ChainEstimate estimate_chain(const PlannedJob& job, const ChainOptions& options, Progress& progress);

/// Of a job that is about to be handed over, as its state is until then, without what another run left.
[[nodiscard]] JobState state_to_hand_over(const BatchFolder& batch, const PlannedJob& job, std::size_t number);

/// Notes that a job of the plan cannot be estimated.
void note_failure(const BatchFolder& batch, const PlannedJob& job, std::size_t number, const ChainEstimate& estimate,
                  Progress& progress);

}  // namespace voxtone::farm
