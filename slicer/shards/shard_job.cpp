// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/shards/shard_job.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/disk/folder_lock.h"
#include "io/files/whole_file.h"
#include "io/layers/gcvf_config.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/job/job_phases.h"
#include "slicer/job/prepared_job.h"
#include "slicer/kept/prepared_body.h"
#include "slicer/layers/layer_maker.h"
#include "slicer/options/job_file.h"
#include "slicer/plan/phase_estimates.h"
#include "slicer/prepare/phase.h"
#include "slicer/shards/shard_cut.h"
#include "slicer/shards/shard_steps.h"
#include "slicer/shards/shard_task.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// What the merge makes one file of the whole stack from.
void keep_for_whole(const PreparedJob& ready, const io::TopmostLayers& topmost, const fs::path& into,
                    const io::ShardRecord& record) {
    const fs::path folder = into / io::whole_folder_name;
    std::error_code error;
    fs::create_directories(folder, error);  // what is wrong says who writes in it
    io::write_staged_file(into / io::shard_topmost_name(record.number), topmost.png());
    if (!record.gcvf) return;
    const io::GcvfPreview preview = io::gcvf_preview(record.stack, BodyPreview(ready.body, true).mesh());
    io::write_staged_file(folder / io::preview_mesh_name, preview.stl);
    io::write_staged_file(folder / io::preview_box_name, preview.box);
}

/// Makes the layers into the folder; with what they hold.
void make_shard(PreparedJob& ready, const LayerRange& mine, const fs::path& into, io::ShardRecord& record,
                Progress& progress) {
    const LayerRange& all = ready.plan.layers;
    record.first_layer = std::uint32_t(mine.first);
    record.layers = std::uint32_t(mine.layers());
    if (mine.layers() == 0) return;
    std::vector<ExpectedStage> stages = expected_stages(ready.plan.phases, {Phase::layers});
    for (ExpectedStage& stage : stages) stage.seconds *= double(mine.layers()) / all.layers();
    expect_stages(progress, std::move(stages));
    io::StackDescription part = record.stack;
    part.first_layer = record.first_layer;
    part.layers = record.layers;
    io::LayerFiles files(into, part, record.resin_bitmaps, std::uint32_t(mine.first - all.first));
    LayerWatchers watchers;
    if (ready.job.options.report) {
        watchers.thumbnails.emplace(all.first, all.layers(), ready.plan.grid, ready.job.palette());
        watchers.voxels.emplace(all.first, all.layers(), ready.plan.grid);
    }
    make_layers(
        *ready.print, mine,
        [&](int k, const io::LayerRuns& layer) { files.write(std::uint32_t(k - mine.first), layer); }, watchers,
        ready.figures, progress);
    record.written = files.written();
    record.topmost_digest = files.topmost()->digest();
    keep_for_whole(ready, *files.topmost(), into, record);
    if (watchers.thumbnails) record.pictures = watchers.thumbnails->take();
    if (watchers.voxels) record.viewer = watchers.voxels->take_layers();
}

}  // namespace

JobResult run_shard_job(const SliceOptions& requested, Progress& progress) {
    const Stopwatch watch;
    // What is made of the layers; the prediction and the report are the merged stack's.
    const OpenedJob opened = open_job(requested, [](const OpenedJob&, JobRun& run) {
        run.why_unpredicted = "A part of the layers is not predicted.";
    });
    expect_shardable(opened);
    const fs::path out = opened.options.out;
    const bool same_job_before = is_same_job(io::shards_folder(out), opened, &progress);
    const ShardTask task = task_of(opened, same_job_before);
    if (auto merged = merged_before(opened, progress)) return *std::move(merged);
    if (same_job_before)
        if (const auto made = made_before(opened, task.number))
            return shard_result(*made, out, "; made already, nothing was done (--overwrite makes it again)");
    if (!opened.options.overwrite) {
        io::expect_free_for_stack(out);
        expect_no_other_shards(opened, &progress);
    }
    expect_own_loop(opened, &progress);
    io::ShardFolder folder(out, task.number);

    const ThreadLimit threads(static_cast<std::size_t>(opened.options.threads));
    for (const std::string& warning : opened.printer.warnings()) progress.warn(warning);
    std::optional<JobBody> kept;
    if (same_job_before) kept = read_prepared(out, recorded_identity(io::shards_folder(out)).value_or(""));
    if (kept && opened.options.strict && !kept->warnings.empty()) kept.reset();  // one may be a reason to stop
    const bool is_kept = kept.has_value();
    PreparedJob ready(opened, std::move(kept), progress);
    const auto& [figures, body, identity, job, plan, print] = ready;
    check_layer_count(plan.grid.size[2], job.printer, "larger (--size), or thicker (--thickness)");
    print->prepare(progress);
    const int slab_layers = print->layers()->slab_layers();
    const LayerRange mine =
        shard_layers(slab_work(body, job.options.colour.depth_mm, slab_layers), slab_layers, plan.layers, task.number);
    expect_disk_space(out, disk_bytes(job, body, mine, {}), progress);

    if (job.outputs().gcvf) io::expect_gcvf(job.describe(plan.grid, plan.layers));
    claim_folder_for_shards(job, folder, job_record(job.options.raw, identity.inputs, out), progress);
    if (!is_kept) keep_prepared(out, identity.job, body);

    io::ShardRecord record;
    record.number = task.number;
    record.first_task = task.first_task;
    record.program = shard_program();
    record.job = identity.job;
    record.host = io::host_name();
    record.stack = io::as_written(job.describe(plan.grid, plan.layers));
    record.resin_bitmaps = job.outputs().resin_bitmaps;
    record.gcvf = job.outputs().gcvf;
    record.png = job.outputs().png;
    make_shard(ready, mine, folder.staging(), record, progress);
    record.figures = shard_figures(figures, watch);
    folder.publish(record);
    return shard_result(record, out, fmt::format(", done in {}", duration_text(watch.total())).c_str());
}

}  // namespace voxtone::slicer
