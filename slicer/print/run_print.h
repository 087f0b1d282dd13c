// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one place that says which run a request is: a body or a tray, whole, a shard of it, or shards laid together.
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/print/estimate_job.h"
#include "slicer/print/merge_job.h"

namespace voxtone::slicer {

struct PrintRequest {
    SliceOptions options;
    TrayModels models = {};  ///< several, or copies of one; empty: that of the options
    bool of_tray = false;    ///< a lone model is a tray of one part
};

/// Slices. Throws Error (with its exit code), as the run that it is says.
[[nodiscard]] JobResult run_print(PrintRequest request, Progress& progress);

/// What slicing would take; nothing is written.
[[nodiscard]] JobEstimate estimate_print(const PrintRequest& request, Progress& progress,
                                         const EstimateScope& scope = {});

/// Lays together the shards that lie in the folder.
[[nodiscard]] JobResult run_merge(const MergeOptions& options, Progress& progress);

}  // namespace voxtone::slicer
