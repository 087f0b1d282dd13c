// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a task has to be told because of what lies in its job's folder when it begins.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "farm/batch/plan.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

/// `--resume` where a loop of this very job was interrupted and this stage runs it; `--overwrite` where something of
/// another job is in the way that the batch may replace (`ours`); else nothing. What other tasks of this job have made
/// is never overwritten. Throws FileError, Cancelled.
[[nodiscard]] std::vector<std::string> words_for_folder(TaskStage stage, const PlannedJob& job, bool ours,
                                                        const Progress& progress);

}  // namespace voxtone::farm
