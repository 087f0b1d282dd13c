// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/shards/shard_job.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/peak_memory.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/disk/folder_lock.h"
#include "io/files/json_writer.h"
#include "io/layers/stack_folder.h"
#include "io/programs/build_identity.h"
#include "io/shards/shard_folder.h"
#include "slicer/job/job_phases.h"
#include "slicer/job/prepared_job.h"
#include "slicer/kept/prepared_body.h"
#include "slicer/layers/layer_maker.h"
#include "slicer/options/job_file.h"
#include "slicer/plan/phase_estimates.h"
#include "slicer/prepare/phase.h"
#include "slicer/shards/shard_cut.h"
#include "slicer/shards/shard_task.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

const std::string this_program = "voxtone " + io::build_identity();

void expect_shardable(const OpenedJob& job) {
    const io::StackOutputs outputs = job.outputs();
    if (outputs.gcvf || outputs.vdb)
        throw UsageError(fmt::format(
            "--shard: {} is one file of the whole stack, which shards do not make: leave it out of --formats, or slice "
            "without --shard",
            outputs.gcvf ? io::gcvf_name : io::vdb_name));
}

JobResult result_of(const io::ShardRecord& record, const fs::path& out, const char* what) {
    const std::string range =
        record.layers == 0 ? "no layers: there are more shards than slabs of layers"
                           : fmt::format("layers {} to {}", record.first_layer, record.first_layer + record.layers - 1);
    const fs::path file = io::shard_file(out, record.number);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-shard-done").add("version", 1).add("record", file.string());
    json.add("shard", record.number.shard).add("of", record.number.of).add("first_layer", record.first_layer);
    json.add("layers", record.layers).add("seconds", record.figures.total_s).end_object();
    return {json.text(), fmt::format("{}: {}{}\n", file.string(), range, what), ExitCode::done};
}

/// The same job's stack, whole: what shards are made for.
std::optional<JobResult> merged_before(const OpenedJob& job, const Progress& progress) {
    const fs::path& out = job.options.out;
    if (job.options.overwrite || !fs::exists(out / io::manifest_name) || !is_same_job(out, job, &progress))
        return std::nullopt;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-shard-done").add("version", 1).add("merged", out.string()).end_object();
    return JobResult{json.text(),
                     fmt::format("{}: holds this job's stack already, whole; nothing was done (--overwrite makes the "
                                 "shard again)\n",
                                 out.string()),
                     ExitCode::done};
}

/// This very shard, with every file.
std::optional<io::ShardRecord> made_before(const OpenedJob& job, const io::ShardNumber& number) {
    const fs::path &out = job.options.out, folder = io::shards_folder(out), file = io::shard_file(out, number);
    if (job.options.overwrite || !fs::exists(file)) return std::nullopt;
    try {
        io::ShardRecord record = io::read_shard(file);
        if (record.number != number || record.program != this_program || record.job != recorded_identity(folder) ||
            io::missing_file(record, folder / io::shard_store(record.job)))
            return std::nullopt;
        return record;
    } catch (const Error&) {
        return std::nullopt;  // it is made again
    }
}

/// The first of the shards that take a folder over from another job clears it, and no other: those that begin at the
/// same time wait, and then find it theirs.
void claim_folder_for_shards(const OpenedJob& job, io::ShardFolder& folder, const std::string& job_text,
                             const Progress& progress) {
    const fs::path shards = io::shards_folder(job.options.out);
    constexpr int tries = 600;
    constexpr std::chrono::milliseconds between(50);
    std::optional<io::FolderLock> lock;
    for (int attempt = 1; !lock; ++attempt) {
        try {
            lock.emplace(shards);
        } catch (const io::FolderHeld&) {
            if (attempt == tries) throw;
            progress.check_cancelled();
            std::this_thread::sleep_for(between);
        }
    }
    if (job.options.overwrite && !is_same_job(shards, job, &progress)) io::remove_shards(job.options.out);
    folder.claim(job_text);
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
    io::LayerFiles files(into, part, record.resin_bitmaps);
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
    if (watchers.thumbnails) record.pictures = watchers.thumbnails->take();
    if (watchers.voxels) record.viewer = watchers.voxels->take_layers();
}

io::ShardFigures figures_of(const JobMeasurements& f, const Stopwatch& since_begin) {
    return {.body_voxels = f.counts.body_voxels,
            .shell_voxels = f.counts.shell_voxels,
            .thin_voxels = f.counts.thin_voxels,
            .solid_s = f.counts.solid_s,
            .shell_s = f.counts.shell_s,
            .colour_s = f.counts.colour_s,
            .screen_s = f.counts.screen_s,
            .runs_s = f.counts.runs_s,
            .encode_s = f.encode_s,
            .layers_s = f.layers_s,
            .total_s = since_begin.total(),
            .peak_memory_bytes = peak_memory_bytes()};
}

/// What is made of the layers; the prediction and the report are the merged stack's.
ShardTask open_shard(OpenedJob& job, bool same_job_before) {
    job.options.prediction.why_not = "A part of the layers is not predicted.";
    if (job.options.shard) return {*job.options.shard, 1};
    return task_of_scheduler(same_job_before ? job.options.out : fs::path());
}

}  // namespace

JobResult run_shard_job(const SliceOptions& asked, Progress& progress) {
    const Stopwatch watch;
    OpenedJob opened = open_job(asked);
    expect_shardable(opened);
    const fs::path out = opened.options.out;
    const bool same_job_before = is_same_job(io::shards_folder(out), opened, &progress);
    const ShardTask task = open_shard(opened, same_job_before);
    if (auto merged = merged_before(opened, progress)) return *std::move(merged);
    if (same_job_before)
        if (const auto made = made_before(opened, task.number))
            return result_of(*made, out, "; made already, nothing was done (--overwrite makes it again)");
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
    PreparedJob ready(std::move(opened), std::move(kept), progress);
    const auto& [figures, body, identity, job, plan, print] = ready;
    check_layer_count(plan.grid.size[2], job.printer, "larger (--size), or thicker (--thickness)");
    print->prepare(progress);
    const int slab_layers = print->layers()->slab_layers();
    const LayerRange mine =
        shard_layers(slab_work(body, job.options.colour.depth_mm, slab_layers), slab_layers, plan.layers, task.number);
    expect_disk_space(out, disk_bytes(job, body, mine), progress);

    claim_folder_for_shards(job, folder, job_record(job.options.raw, identity.inputs, out), progress);
    if (!is_kept) keep_prepared(out, identity.job, body);

    io::ShardRecord record;
    record.number = task.number;
    record.first_task = task.first_task;
    record.program = this_program;
    record.job = identity.job;
    record.host = io::host_name();
    record.stack = io::as_written(job.describe(plan.grid, plan.layers));
    record.resin_bitmaps = job.outputs().resin_bitmaps;
    make_shard(ready, mine, folder.staging(), record, progress);
    record.figures = figures_of(figures, watch);
    folder.publish(record);
    return result_of(record, out, fmt::format(", done in {}", duration_text(watch.total())).c_str());
}

}  // namespace voxtone::slicer
