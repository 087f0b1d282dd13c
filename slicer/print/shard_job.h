// SPDX-License-Identifier: GPL-3.0-or-later
//
// One body in shards (run_shard.h). Of the work before the layers, reading, repairing and separating are done by the
// first shard and kept for the others (prepared_body.h); shards that begin before it has done so do it too. The
// appearance loop is never repeated (part/skin_file.h).
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// As run_shard.
[[nodiscard]] JobResult run_shard_job(const SliceOptions& requested, Progress& progress);

}  // namespace voxtone::slicer
