// SPDX-License-Identifier: GPL-3.0-or-later
//
// One shard of a print: the layers of a part of it, to be laid together by merge_job.h. The same options as the whole
// print's make it, on any machine that sees the output folder; what lies there (io/shards/shard_folder.h) is no stack
// until then. A body (shard_job.h) and the parts of a tray (tray_shard.h) are cut, made and published alike.
#pragma once

#include <functional>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "io/layers/manifest.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/opened_job.h"
#include "slicer/plate/job_phases.h"

namespace voxtone::slicer {

/// A print of which any layers can be made. What it refers to outlasts it.
struct ShardedPrint {
    const OpenedJob& job;  ///< for printer, resins and formats
    const JobIdentity& identity;
    const VoxelGrid& grid;
    LayerRange layers;  ///< that all shards together make
    int slab_layers = 1;
    std::vector<double> work;  ///< of each slab (shard_cut.h)
    std::vector<io::StackMember> members{};
    const JobBody* body = nullptr;  ///< for a container's preview; null: it has none

    std::function<void(const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers,
                       JobMeasurements& figures)>
        make;
    /// Throws TryAgain where the disk has no room for these layers.
    std::function<void(const LayerRange& mine)> expect_disk = [](const LayerRange&) {};
    /// What other shards need not do again, once the folder is this job's.
    std::function<void()> keep = [] {};
};

struct ShardSteps {
    /// `same_job_before`: shards of this job lie there, and what the first of them kept.
    std::function<ShardedPrint(bool same_job_before)> prepare;
    /// The last refusal before: of loops that were run elsewhere.
    std::function<void()> expect_loops = [] {};
};

/// Throws UsageError for outputs that are one file of the whole stack.
void expect_shardable(const OpenedJob& job);

/// Nothing is done, and told so, where the same job's shard or merged stack is there, whole. Throws Error: then there
/// is no such shard, or the one that was there.
[[nodiscard]] JobResult run_shard(const OpenedJob& job, const ShardSteps& steps, Progress& progress);

}  // namespace voxtone::slicer
