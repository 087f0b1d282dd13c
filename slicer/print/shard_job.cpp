// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/shard_job.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "io/shards/shard_folder.h"
#include "slicer/part/phase.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/part/prepared_body.h"
#include "slicer/plate/prepared_job.h"
#include "slicer/print/run_shard.h"
#include "slicer/print/shard_cut.h"

namespace voxtone::slicer {

namespace {

/// As the first shard left it.
std::optional<JobBody> kept_body(const OpenedJob& job) {
    const std::filesystem::path& out = job.options.out;
    std::optional<JobBody> kept = read_prepared(out, recorded_identity(io::shards_folder(out)).value_or(""));
    if (kept && job.options.strict && !kept->warnings.empty()) kept.reset();  // one may be a reason to stop
    return kept;
}

ShardedPrint sharded(PreparedJob& ready, bool is_kept, Progress& progress) {
    const std::filesystem::path& out = ready.job.options.out;
    const int slab_layers = ready.print->layers()->slab_layers();
    const auto make = [&](const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers,
                          JobMeasurements& figures) {
        std::vector<ExpectedStage> stages = expected_stages(ready.plan.phases, {Phase::layers});
        for (ExpectedStage& stage : stages) stage.seconds *= double(mine.layers()) / ready.plan.layers.layers();
        expect_stages(progress, std::move(stages));
        make_layers(*ready.print, mine, take, watchers, figures, progress);
    };
    return {.job = ready.job,
            .identity = ready.identity,
            .grid = ready.plan.grid,
            .layers = ready.plan.layers,
            .slab_layers = slab_layers,
            .work = slab_work(ready.body, ready.job.options.colour.depth_mm, slab_layers),
            .body = &ready.body,
            .make = make,
            .expect_disk =
                [&](const LayerRange& mine) {
                    expect_disk_space(out, disk_bytes(ready.job, ready.body, mine, {}), progress);
                },
            .keep =
                [&, is_kept] {
                    if (!is_kept) keep_prepared(out, ready.identity.job, ready.body);
                }};
}

}  // namespace

JobResult run_shard_job(const SliceOptions& requested, Progress& progress) {
    // What is made of the layers; the prediction and the report are the merged stack's.
    const OpenedJob opened = open_job(requested, [](const OpenedJob&, JobRun& run) {
        run.why_unpredicted = "A part of the layers is not predicted.";
    });
    expect_shardable(opened);
    std::optional<PreparedJob> ready;
    const auto prepare = [&](bool same_job_before) {
        for (const std::string& warning : opened.printer.warnings()) progress.warn(warning);
        std::optional<JobBody> kept = same_job_before ? kept_body(opened) : std::nullopt;
        const bool is_kept = kept.has_value();
        ready.emplace(opened, std::move(kept), progress);
        check_layer_count(ready->plan.grid.size[2], ready->job.printer, "larger (--size), or thicker (--thickness)");
        ready->print->prepare(progress);
        return sharded(*ready, is_kept, progress);
    };
    return run_shard(opened, {prepare, [&] { expect_own_loop(opened, &progress); }}, progress);
}

}  // namespace voxtone::slicer
