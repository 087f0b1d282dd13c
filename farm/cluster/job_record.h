// SPDX-License-Identifier: GPL-3.0-or-later
//
// The state of a job of a batch (batch/job_state.h) that several tasks work on, on several machines at once: each
// change is made under the job's lock, to what the state is then.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/progress.h"
#include "farm/batch/batch_folder.h"
#include "farm/cluster/submission.h"

namespace voxtone::farm {

/// The job that was handed over, as a plan has it. Throws FileError, InputError.
[[nodiscard]] PlannedJob handed_over_job(const BatchFolder& batch, const std::string& name);

/// Waits for a lock that others hold for moments; null where one holds it longer, as a local batch does.
[[nodiscard]] std::unique_ptr<io::FolderLock> wait_for_job(const BatchFolder& batch, const std::string& name);

/// Changes the state, and publishes it. Where that cannot be it is warned of: what was made stays made, and the end of
/// the batch is told from the folders.
void change_state(const BatchFolder& batch, const std::string& name, Progress& progress,
                  const std::function<void(JobState&)>& change);

/// Notes that the job's stack is there. Throws Error where it cannot be read.
void note_stack(JobState& state, const BatchFolder& batch, const PlannedJob& job, const Submission& submission,
                Progress& progress);

/// A summary that cannot be written takes nothing from what was done.
void summarise_batch(const BatchFolder& batch, Progress& progress);
/// For a task whose job's state has just been published: the summary reads all states, so it is drawn where the last
/// one is older than a minute and than a tenth of a second for each job of the plan (`jobs`; 0: not known). However
/// many tasks end, states are read ten times a second at most. One task draws it, others leave it to that.
void summarise_at_times(const BatchFolder& batch, const std::string& name, std::size_t jobs, Progress& progress);

}  // namespace voxtone::farm
