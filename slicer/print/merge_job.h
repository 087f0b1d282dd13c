// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lays the shards of a job together: OUT becomes the stack that the unsharded job would have made, bit for bit, by
// renames alone (io/shards/merged_stack.h). Then the report is drawn, for which the model is read again, as the job
// file names it; no layer is.
//
// The report is the unsharded job's, with two differences: times are those of the shards, added, and the print is not
// predicted unless that is asked for. Then its layers are made once more, in memory, for the model that predicts.
#pragma once

#include <filesystem>
#include <functional>

#include "base/job_result.h"
#include "base/progress.h"
#include "io/shards/merged_stack.h"

namespace voxtone::slicer {

struct MergeOptions {
    std::filesystem::path out;
    bool overwrite = false;             ///< replace another job's stack
    bool report = true;                 ///< where the job asked for one
    bool predict = false;               ///< as the job asks
    std::filesystem::path for_printer;  ///< where OUT/printer goes besides; empty: nowhere
    int threads = 0;
    int shards = 0;  ///< how many there are known to be; 0: those that lie there
};

/// What is told of a stack once it is whole: of a body here, of a tray in merged_tray.h.
struct MergedTelling {
    std::function<bool(const io::ShardSet& shards)> is_told;       ///< it was before
    std::function<JobResult(const io::ShardSet& shards)> tell_of;  ///< with a report
};

/// The report of a body.
[[nodiscard]] MergedTelling telling_of_body(const MergeOptions& options, Progress& progress);

/// Where all is there already, nothing is done. Throws Error: OUT is what it was then, or holds the whole stack without
/// its report.
[[nodiscard]] JobResult run_merge_job(const MergeOptions& options, const MergedTelling& telling, Progress& progress);

}  // namespace voxtone::slicer
