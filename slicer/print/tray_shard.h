// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tray in shards, as one body in shards (shard_job.h): each makes a part of the print's layers, of all parts
// that reach into them. What the loops of the parts came to must lie in OUT/parts (`--until loop`). Laid together they
// are the bits of the tray in one go.
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/print/merge_job.h"

namespace voxtone::slicer {

/// As run_shard_job. A part that fails is the end of it: all shards must be of the same parts. Throws Error.
[[nodiscard]] JobResult run_tray_shard(const SliceOptions& asked, const TrayModels& models, Progress& progress);

/// Of a tray's stack, for run_merge_job. With `predict` the parts are predicted, for which their layers are made once
/// more, in memory, and the page is drawn; without, tray.json and the figures are written alone.
[[nodiscard]] MergedTelling telling_of_tray(const MergeOptions& options, Progress& progress);

}  // namespace voxtone::slicer
