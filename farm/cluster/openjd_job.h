// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone batch --openjd FILE`: what is left of a plan as a job template of Open Job Description
// (openjd_template.h), to be given to a render manager. The jobs are noted in the batch's folder as those that Slurm
// is given are (submission.h), so that the tasks of the template find them there.
#pragma once

#include <filesystem>

#include "base/job_result.h"
#include "base/progress.h"
#include "farm/batch/plan.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

struct OpenJobOptions {
    std::filesystem::path out;
    std::filesystem::path program;  ///< `voxtone`, as every worker finds it
    std::filesystem::path file;     ///< the template
    ChainOptions chain;
};

/// Exit code 0; where jobs cannot even be estimated, which stand as failed, that of the first of them. Where nothing is
/// left no template is written. Throws Error where nothing was noted or written.
[[nodiscard]] JobResult run_openjd_job(const PlanOptions& plan, const OpenJobOptions& options, Progress& progress);

}  // namespace voxtone::farm
