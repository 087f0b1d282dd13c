// SPDX-License-Identifier: GPL-3.0-or-later
//
// One shard of a job: the layers of a part of the print, to be laid together by merge_job.h. The same options as the
// whole job's make it, on any machine that sees the output folder; what lies there (io/shards/shard_folder.h) is no
// stack until then. Of the work before
// the layers, reading, repairing and separating are done by the first shard and kept for the others (prepared_body.h);
// shards that begin before it has done so do it too. The appearance loop is never repeated (saved/skin_file.h).
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// Nothing is done, and told so, where the same job's shard or merged stack is there, whole. Throws Error: then there
/// is no such shard, or the one that was there.
[[nodiscard]] JobResult run_shard_job(const SliceOptions& requested, Progress& progress);

}  // namespace voxtone::slicer
