// SPDX-License-Identifier: GPL-3.0-or-later
//
// One shard of a print: the layers of a part of it, to be laid together by merge_job.h. The same options as the whole
// print's make it, on any machine that sees the output folder; what lies there (io/shards/shard_folder.h) is no stack
// until then.
#pragma once

#include "slicer/print/plate.h"

namespace voxtone::slicer {

/// Nothing is done, and told so, where the same job's shard or merged stack is there, whole. Throws Error: then there
/// is no such shard, or the one that was there; UsageError for outputs that are one file of the whole stack.
[[nodiscard]] JobResult run_shard(Plate& plate, Progress& progress);

}  // namespace voxtone::slicer
