// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tasks that Slurm ended for memory. Its poll (OverMemoryKill) ends all of a task at once, with the state FAILED, and a
// control group may: then nobody of ours is left to say so. It is told from what Slurm writes into the task's output,
// or from the state OUT_OF_MEMORY. Such a stage is given twice what it had when it is handed over again.
#pragma once

#include <optional>
#include <string>

#include "farm/cluster/submission.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

/// Whether what Slurm wrote says that it ended a task for memory.
[[nodiscard]] bool tells_of_too_little_memory(const std::string& output);

/// The stage of a job's that was ended so; nothing: none, or it cannot be told.
[[nodiscard]] std::optional<TaskStage> starved_stage(const SubmissionFolder& files, const Submission& submission);

/// Notes it with the submission as it is on disk now, for the next one.
void note_starved(const SubmissionFolder& files, const std::string& job, TaskStage stage);

/// Gives stages what they need by what happened to them before (`before`, of the same job). What was changed, in a
/// sentence; empty: nothing.
[[nodiscard]] std::string give_more_memory(TaskChain& chain, const Submission& before);

}  // namespace voxtone::farm
