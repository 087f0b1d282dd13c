// SPDX-License-Identifier: GPL-3.0-or-later
//
// One shard of a print: the layers of a part of it, to be laid together by merge_job.h. The same options as the whole
// print's make it, on any machine that sees the output folder; what lies there (io/shards/shard_folder.h) is no stack
// until then. A body (shard_job.h) and the parts of a tray (tray_shard.h) are cut, made and published alike.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "io/layers/manifest.h"
#include "slicer/job/job_phases.h"
#include "slicer/kept/job_identity.h"
#include "slicer/prepare/opened_job.h"

namespace voxtone::slicer {

/// A print of which any layers can be made.
class ShardedPrint {
public:
    ShardedPrint() = default;
    ShardedPrint(const ShardedPrint&) = delete;
    ShardedPrint& operator=(const ShardedPrint&) = delete;
    virtual ~ShardedPrint() = default;

    /// For printer, resins and formats.
    [[nodiscard]] virtual const OpenedJob& job() const = 0;
    [[nodiscard]] virtual const JobIdentity& identity() const = 0;
    [[nodiscard]] virtual const VoxelGrid& grid() const = 0;
    /// That all shards together make.
    [[nodiscard]] virtual LayerRange layers() const = 0;
    [[nodiscard]] virtual int slab_layers() const = 0;
    /// Of each slab (shard_cut.h).
    [[nodiscard]] virtual std::vector<double> work() const = 0;
    [[nodiscard]] virtual std::vector<io::StackMember> members() const { return {}; }
    /// For a container's preview; null: it has none.
    [[nodiscard]] virtual const JobBody* body() const { return nullptr; }

    /// Throws TryAgain where the disk has no room for these layers.
    virtual void expect_disk(const LayerRange& /*mine*/, Progress& /*progress*/) const {}
    /// What other shards need not do again, once the folder is this job's.
    virtual void keep() const {}
    virtual void make(const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers, JobMeasurements& figures,
                      Progress& progress) = 0;
};

struct ShardSteps {
    /// The last refusal before the print is prepared: of loops that were run elsewhere.
    std::function<void()> expect_loops = [] {};
    /// `same_job_before`: shards of this job lie there, and what the first of them kept.
    std::function<std::unique_ptr<ShardedPrint>(bool same_job_before)> prepare{};
};

/// Throws UsageError for outputs that are one file of the whole stack.
void expect_shardable(const OpenedJob& job);

/// Nothing is done, and told so, where the same job's shard or merged stack is there, whole. Throws Error: then there
/// is no such shard, or the one that was there.
[[nodiscard]] JobResult run_shard(const OpenedJob& job, const ShardSteps& steps, Progress& progress);

}  // namespace voxtone::slicer
