// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verb `batch`: a plan's jobs, each a process of its own, until none is left. There is no daemon and nothing to
// break: who runs the same again does what is left, on any number of machines that share the folder.
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "farm/batch/batch_view.h"
#include "farm/batch/plan.h"
#include "farm/batch/queued_job.h"

namespace voxtone::farm {

/// All done: exit code 0. Else that of the first failed job of the plan that is to be looked at by a person, and 75
/// where all that failed may go another time. Throws Error where nothing was begun; Cancelled once what ran has saved
/// itself.
JobResult run_batch_job(const PlanOptions& plan, const BatchOptions& options, BatchView& view, Progress& progress);

/// The same for the models that arrive in a folder (arrivals.h), those that lie there first, until it is told to stop:
/// throws Cancelled then. `plan` names no plan, and its names do not count. What is wrong with one model is warned
/// about.
[[noreturn]] void run_watch_job(const std::filesystem::path& folder, const PlanOptions& plan,
                                const BatchOptions& options, BatchView& view, Progress& progress);

/// The same, and what arrives is told of (BatchView::arrived) and not sliced: for who has a queue of his own.
[[noreturn]] void run_arrivals_job(const std::filesystem::path& folder, const PlanOptions& plan,
                                   const BatchOptions& options, BatchView& view, Progress& progress);

/// The commands of a plan, one a line for a shell.
[[nodiscard]] JobResult print_batch_commands(const PlanOptions& plan, const std::filesystem::path& program,
                                             Progress& progress);

}  // namespace voxtone::farm
