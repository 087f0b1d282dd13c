// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verb `task`: one task of a batch that was handed to Slurm (slurm_job.h) or given away as a template
// (openjd_job.h), on whatever machine it was given. It
// starts the program that does the work and does for it what a local batch does: its log, its state, what has to be
// said because of what lies in its folder. A task that may go another time (exit codes 75 and 85) is put back into
// the queue, a bounded number of times. Every task may run twice, also at once.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "base/job_result.h"
#include "base/progress.h"
#include "farm/cluster/task_chain.h"
#include "io/shards/shard_number.h"

namespace voxtone::farm {

/// Takes whole lines.
using MessageSink = std::function<void(std::string_view)>;

struct TaskOptions {
    std::filesystem::path out;      ///< of the batch
    std::filesystem::path program;  ///< `voxtone`
    std::string job;
    TaskStage stage = TaskStage::whole;
    std::optional<io::ShardNumber> shard;  ///< of the stage `layers`
    int retries = 5;
    int threads = 0;                 ///< of the work, where its job does not say; 0: as many as it was given
    double requeue_patience_s = 20;  ///< until Slurm has ended a task that it was told to put back
    MessageSink relay;  ///< where messages of Open Job Description go; empty: the work is not asked for them
};

/// The exit code is that of the work; of work that was tried often enough it is 5, so that no scheduler tries again.
/// Throws Error where there is no such task.
[[nodiscard]] JobResult run_cluster_task(const TaskOptions& options, Progress& progress);

/// When all has ended: a job that no task of the queue works on any more is done or has failed. Draws the summary.
[[nodiscard]] JobResult close_cluster_batch(const std::filesystem::path& out, Progress& progress);

}  // namespace voxtone::farm
