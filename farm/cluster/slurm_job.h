// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone batch --slurm`: what is left of a plan is handed to Slurm, a chain of jobs for each job of the plan
// (task_chain.h). A chain is its own: where a task fails the tasks behind it never start, and no other job is touched.
// One job more waits for all chains to end and tells what became of them (cluster_task.h). The same command again
// hands over what is left, and nothing that waits or runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "farm/batch/plan.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

struct SlurmOptions {
    std::filesystem::path out;
    std::filesystem::path program;  ///< `voxtone`, as every node finds it
    ChainOptions chain;
    int throttle = 0;                       ///< most tasks at once, of those that this call submits; 0: any number
    int retries = 5;                        ///< of a task that may go another time
    std::vector<std::string> sbatch_words;  ///< of the user's, for each sbatch
    bool dry_run = false;                   ///< print the scripts; write and submit nothing
};

/// Exit code 0 where all that was left is submitted; where jobs cannot even be estimated, which stand as failed, that
/// of the first of them. Throws Error where Slurm is not there, does not answer or refuses: the job that was refused is
/// not in the queue, those before it are and are noted.
[[nodiscard]] JobResult run_slurm_job(const PlanOptions& plan, const SlurmOptions& options, Progress& progress);

}  // namespace voxtone::farm
