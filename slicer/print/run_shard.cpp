// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/run_shard.h"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/disk/folder_lock.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/layers/gcvf_config.h"
#include "io/layers/stack_folder.h"
#include "io/programs/build_identity.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/plate/output_folder.h"
#include "slicer/print/shard_cut.h"
#include "slicer/print/shard_task.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// Of the record of a shard: shards of two programs do not go together.
std::string shard_program() { return "voxtone " + io::build_identity(); }

/// Which shard is asked for.
ShardTask task_of(const OpenedJob& job, bool same_job_before) {
    if (job.options.shard) return {*job.options.shard, 1};
    return task_of_scheduler(same_job_before ? job.options.out : fs::path());
}

JobResult shard_result(const io::ShardRecord& record, const fs::path& out, const char* what) {
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
        if (record.number != number || record.program != shard_program() || record.job != recorded_identity(folder) ||
            io::missing_file(record, folder / io::shard_store(record.job)))
            return std::nullopt;
        return record;
    } catch (const Error&) {
        return std::nullopt;  // it is made again
    }
}

/// The first of the shards that take a folder over from another job clears it, and no other: those that begin at the
/// same time wait, and then find it theirs.
void claim_folder(const OpenedJob& job, io::ShardFolder& folder, const std::string& job_text,
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
    if (!job.options.overwrite)
        expect_no_other_shards(job.options.out, job, &progress);  // one may have come while this one read its model
    else if (!is_same_job(shards, job, &progress))
        io::remove_shards(job.options.out);
    folder.claim(job_text);
}

io::ShardFigures shard_figures(const JobMeasurements& f, const Stopwatch& since_begin) {
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

io::ShardRecord record_of(const ShardedPrint& print, const ShardTask& task) {
    io::ShardRecord record;
    record.number = task.number;
    record.first_task = task.first_task;
    record.program = shard_program();
    record.job = print.identity.job;
    record.host = io::host_name();
    record.stack = io::as_written(print.job.describe(print.grid, print.layers));
    record.stack.members = print.members;
    const io::StackOutputs outputs = print.job.outputs();
    record.resin_bitmaps = outputs.resin_bitmaps;
    record.gcvf = outputs.gcvf;
    record.png = outputs.png;
    return record;
}

/// What the merge makes one file of the whole stack from.
void keep_for_whole(const ShardedPrint& print, const io::TopmostLayers& topmost, const fs::path& into,
                    const io::ShardRecord& record) {
    const fs::path folder = into / io::whole_folder_name;
    std::error_code error;
    fs::create_directories(folder, error);  // what is wrong says who writes in it
    io::write_staged_file(into / io::shard_topmost_name(record.number), topmost.png());
    if (!record.gcvf || !print.body) return;
    const io::GcvfPreview preview = io::gcvf_preview(record.stack, BodyPreview(*print.body, true).mesh());
    io::write_staged_file(folder / io::preview_mesh_name, preview.stl);
    io::write_staged_file(folder / io::preview_box_name, preview.box);
}

/// Makes the layers into the folder; with what they hold.
void make_shard(const ShardedPrint& print, const LayerRange& mine, const fs::path& into, io::ShardRecord& record,
                JobMeasurements& figures) {
    record.first_layer = std::uint32_t(mine.first);
    record.layers = std::uint32_t(mine.layers());
    if (mine.layers() == 0) return;
    io::StackDescription part = record.stack;
    part.first_layer = record.first_layer;
    part.layers = record.layers;
    io::LayerFiles files(into, part, record.resin_bitmaps, std::uint32_t(mine.first - print.layers.first));
    LayerWatchers watchers;
    if (print.job.options.report) watchers.watch(print.layers, print.grid, print.job);
    print.make(
        mine, [&](int k, const io::LayerRuns& layer) { files.write(std::uint32_t(k - mine.first), layer); }, watchers,
        figures);
    record.written = files.written();
    record.topmost_digest = files.topmost()->digest();
    keep_for_whole(print, *files.topmost(), into, record);
    if (watchers.thumbnails) record.pictures = watchers.thumbnails->take();
    if (watchers.voxels) record.viewer = watchers.voxels->take_layers();
}

void expect_shardable(const OpenedJob& job) {
    if (job.outputs().vdb)
        throw UsageError(fmt::format(
            "--shard: {} is one file of the whole stack, which shards do not make: leave it out of --formats, or slice "
            "without --shard",
            io::vdb_name));
}

}  // namespace

JobResult run_shard(Plate& plate, Progress& progress) {
    const Stopwatch watch;
    const OpenedJob& job = plate.job();
    expect_shardable(job);
    const fs::path& out = job.options.out;
    const bool same_job_before = is_same_job(io::shards_folder(out), job, &progress);
    const ShardTask task = task_of(job, same_job_before);
    if (auto merged = merged_before(job, progress)) return *std::move(merged);
    if (same_job_before)
        if (const auto made = made_before(job, task.number))
            return shard_result(*made, out, "; made already, nothing was done (--overwrite makes it again)");
    if (!job.options.overwrite) {
        io::expect_free_for_stack(out);
        expect_no_other_shards(out, job, &progress);
    }
    plate.expect_loops(progress);
    io::ShardFolder folder(out, task.number);

    const ThreadLimit threads(static_cast<std::size_t>(job.options.threads));
    const ShardedPrint print = plate.prepare_for_shards(same_job_before, progress);
    expect_shardable(print.job);
    const LayerRange mine = shard_layers(print.work, print.slab_layers, print.layers, task.number);
    print.expect_disk(mine);
    io::ShardRecord record = record_of(print, task);
    if (record.gcvf) io::expect_gcvf(record.stack);
    claim_folder(job, folder, job_record(job.options.raw, print.identity.inputs, out), progress);
    print.keep();
    JobMeasurements figures;
    make_shard(print, mine, folder.staging(), record, figures);
    record.figures = shard_figures(figures, watch);
    folder.publish(record);
    return shard_result(record, out, fmt::format(", done in {}", duration_text(watch.total())).c_str());
}

}  // namespace voxtone::slicer
