// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a request prints: a plate of parts, of which one body by itself is the simplest (body_plate.h) and a tray of
// many the other (tray_plate.h). Every run goes the same way whichever it is: all layers at once (run_whole.h), a shard
// of them (run_shard.h), shards laid together (merge_job.h). What differs they ask here.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "base/stopwatch.h"
#include "io/layers/manifest.h"
#include "io/layers/stack_folder.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/opened_job.h"
#include "slicer/plate/job_phases.h"

namespace voxtone::slicer {

/// A print of which any layers can be made. What it refers to is the plate's.
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
    std::function<void(const LayerRange& mine)> expect_disk;
    /// What other shards need not do again, once the folder is this job's.
    std::function<void()> keep = [] {};
};

/// Opened when it is made, as far as no folder is needed for that. Each call throws Error (with its exit code).
class Plate {
public:
    Plate() = default;
    Plate(const Plate&) = delete;
    Plate& operator=(const Plate&) = delete;
    virtual ~Plate() = default;

    // All layers at once: each is called once, in this order.

    /// Takes the output folder, which is this job's from here on; what it holds stays until the new stack is whole.
    [[nodiscard]] virtual io::StackFolder take_folder(Progress& progress) = 0;
    /// What was said when this very job was done, where nothing is left of it to do but to hand it over.
    [[nodiscard]] virtual std::optional<JobResult> done_before(const io::StackFolder& folder, Progress& progress) = 0;
    /// Throws InputError where the folder holds what the job may not replace.
    virtual void expect_replaceable(const io::StackFolder& folder, Progress& progress) = 0;
    /// Reads models and separates colours: the last that may refuse the job, for want of disk too.
    virtual void prepare(Progress& progress) = 0;
    /// Looks at the print and rearranges its resins, for hours if need be. The end of a job that goes so far.
    [[nodiscard]] virtual std::optional<JobResult> rearrange(Progress& progress) = 0;
    /// Makes the layers, puts the stack, or each of several, into its place, and tells of it.
    [[nodiscard]] virtual JobResult print(io::StackFolder folder, const Stopwatch& since_begin, Progress& progress) = 0;

    // Layers of a shard.

    /// Also of the plate whole, once its folder is taken.
    [[nodiscard]] virtual const OpenedJob& job() const = 0;
    /// The last refusal before anything is read: of loops that were to be run elsewhere.
    virtual void expect_loops(Progress& /*progress*/) {}
    /// `same_job_before`: shards of this job lie there, and what the first of them kept.
    [[nodiscard]] virtual ShardedPrint prepare_for_shards(bool same_job_before, Progress& progress) = 0;
};

}  // namespace voxtone::slicer
