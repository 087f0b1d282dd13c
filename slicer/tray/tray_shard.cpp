// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_shard.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/disk/folder_lock.h"
#include "io/files/json_object.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/kept/report_files.h"
#include "slicer/options/job_file.h"
#include "slicer/prepare/phase.h"
#include "slicer/shards/shard_cut.h"
#include "slicer/shards/shard_steps.h"
#include "slicer/tray/opened_tray.h"
#include "slicer/tray/part_reports.h"
#include "slicer/tray/tray_layers.h"
#include "slicer/tray/tray_record.h"
#include "slicer/tray/tray_report.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// Of each slab of the part's own.
std::vector<double> work_of(const ReadyPart& part, int slab_layers) {
    if (part.ready) return slab_work(part.ready->body, part.ready->job.options.colour.depth_mm, slab_layers);
    // Its mixtures are known: reading and screening take a small part of what finding them would.
    constexpr double work_of_voxel = 0.02;
    const int layers = part.grid().size[2];
    const double of_layer = work_of_voxel * double(part.component->all_voxels()) / layers;
    std::vector<double> work(std::size_t((layers + slab_layers - 1) / slab_layers));
    for (int k = 0; k < layers; ++k) work[std::size_t(k / slab_layers)] += of_layer;
    return work;
}

/// Work of each slab of the print: of every part once for each height it stands at, as its layers are made. A copy in
/// another place of the same height takes little more.
std::vector<double> slab_work_of(const PreparedTray& prepared, int slab_layers) {
    const int layers = prepared.places.trays[0].size[2];
    std::vector<double> work(std::size_t((layers + slab_layers - 1) / slab_layers));
    for (const ReadyPart& part : prepared.parts.ready) {
        if (part.alone.empty()) continue;
        const std::vector<double> own = work_of(part, slab_layers);
        std::vector<int> heights;
        for (const PlacedCopy& copy : part.alone) heights.push_back(copy.at[2]);
        std::ranges::sort(heights);
        heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
        for (const int height : heights)
            for (std::size_t slab = 0; slab < own.size(); ++slab)
                work[std::min(work.size() - 1, slab + std::size_t(height / slab_layers))] += own[slab];
    }
    return work;
}

/// Parts that were looped before, ready to make layers.
void take_loops(PreparedTray& prepared, Progress& progress) {
    for (ReadyPart& part : prepared.parts.ready)
        if (!part.alone.empty() && part.ready) part.ready->print->prepare(progress);
}

void make_layers_of(const PreparedTray& prepared, const ComposedLayers& layers, const LayerRange& mine,
                    const fs::path& into, io::ShardRecord& record, Progress& progress) {
    record.first_layer = std::uint32_t(mine.first);
    record.layers = std::uint32_t(mine.layers());
    if (mine.layers() == 0) return;
    io::StackDescription part = record.stack;
    part.first_layer = record.first_layer;
    part.layers = record.layers;
    io::LayerFiles files(into, part, record.resin_bitmaps, record.first_layer);
    LayerWatchers watchers;
    const OpenedJob& any = prepared.any_job();
    if (any.options.report) watch_all(watchers, layers.grid(), any);
    make_tray_layers(
        layers, mine, [&](int k, const io::LayerRuns& layer) { files.write(std::uint32_t(k - mine.first), layer); },
        watchers, progress);
    record.written = files.written();
    record.topmost_digest = files.topmost()->digest();
    std::error_code error;
    fs::create_directories(into / io::whole_folder_name, error);  // what is wrong says who writes in it
    io::write_staged_file(into / io::shard_topmost_name(record.number), files.topmost()->png());
    if (watchers.thumbnails) record.pictures = watchers.thumbnails->take();
    if (watchers.voxels) record.viewer = watchers.voxels->take_layers();
}

OpenedTray open_shard_of_tray(const SliceOptions& asked) {
    if (asked.trays > 1) throw UsageError("--shard: is of one tray; leave --trays out");
    OpenedTray tray = open_tray(asked);
    tray.plan.common.fail_fast = true;
    return tray;
}

/// The merged stack's tray, for what is told of it.
OpenedTray open_merged_tray(const MergeOptions& options, const Progress& progress) {
    SliceOptions asked;
    read_job((options.out / job_file_name).string(), asked);
    asked.out = options.out.string();
    asked.threads = options.threads;
    OpenedTray tray = open_shard_of_tray(asked);
    if (!is_same_job(options.out, tray.job, &progress))
        throw InputError(fmt::format(
            "{}: the stack is merged and whole, but nothing can be told of its parts: the plan, or a file that it "
            "names, has changed since the shards were made; --no-report does without",
            options.out.string()));
    tray.plan.loops_elsewhere = true;  // by a task of their own
    return tray;
}

/// Whether tray.json tells of this stack already.
bool is_told(const fs::path& out, const io::StackDescription& stack) {
    try {
        return io::JsonObject::read(out / tray_file_name).text("content_sha256") == stack.content_sha256;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

JobResult run_tray_shard(const SliceOptions& asked, const TrayModels& models, Progress& progress) {
    const Stopwatch watch;
    if (asked.out.empty()) throw UsageError("tray: name the folder for the print (-o OUT)");
    if (!asked.overwrite && !models.empty()) io::expect_free_for_stack(asked.out);
    OpenedTray tray = open_shard_of_tray(with_plan(asked, models));
    const OpenedJob& job = tray.job;
    const fs::path out = job.options.out;
    const bool same_job_before = is_same_job(io::shards_folder(out), job, &progress);
    const ShardTask task = task_of(job, same_job_before);
    if (auto merged = merged_before(job, progress)) return *std::move(merged);
    if (same_job_before)
        if (const auto made = made_before(job, task.number))
            return shard_result(*made, out, "; made already, nothing was done (--overwrite makes it again)");
    if (!job.options.overwrite) {
        io::expect_free_for_stack(out);
        expect_no_other_shards(job, &progress);
    }
    io::ShardFolder folder(out, task.number);
    const ThreadLimit threads(static_cast<std::size_t>(job.options.threads));
    PreparedTray prepared = prepare_tray(tray, progress);
    expect_shardable(prepared.any_job());
    if (prepared.any_job().outputs().gcvf)
        throw UsageError(
            fmt::format("--shard: {} of a tray is not made in shards: leave it out of --formats, or slice "
                        "without --shard",
                        io::gcvf_name));
    take_loops(prepared, progress);
    const ComposedLayers layers = compose(prepared, 0);
    const LayerRange all{0, layers.grid().size[2] - 1};
    const LayerRange mine =
        shard_layers(slab_work_of(prepared, layers.slab_layers()), layers.slab_layers(), all, task.number);
    claim_folder_for_shards(job, folder, job_record(job.options.raw, prepared.identity.inputs, out), progress);

    io::ShardRecord record;
    record.number = task.number;
    record.first_task = task.first_task;
    record.program = shard_program();
    record.job = prepared.identity.job;
    record.host = io::host_name();
    record.stack = io::as_written(prepared.any_job().describe(layers.grid(), all));
    record.stack.members = members_of(prepared, 0);
    record.resin_bitmaps = prepared.any_job().outputs().resin_bitmaps;
    record.png = prepared.any_job().outputs().png;
    make_layers_of(prepared, layers, mine, folder.staging(), record, progress);
    record.figures = shard_figures({}, watch);
    folder.publish(record);
    return shard_result(record, out, fmt::format(", done in {}", duration_text(watch.total())).c_str());
}

JobResult run_tray_merge(const MergeOptions& options, Progress& progress) {
    const Stopwatch watch;
    MergeOptions plain = options;
    plain.report = false;
    JobResult merged = run_merge_job(plain, progress);
    if (!options.report) return merged;
    const io::StackDescription stack = io::read_manifest(options.out / io::manifest_name);
    if (!options.predict && is_told(options.out, stack)) return merged;
    const OpenedTray tray = open_merged_tray(options, progress);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    PreparedTray prepared = prepare_tray(tray, progress);
    take_loops(prepared, progress);
    TrayReport report = report_for(prepared, tray.plan.common.out);
    LayerWatchers watchers;
    const bool has_page = options.predict && prepared.any_job().options.report;
    PartReports parts(prepared, 0, has_page);
    const ComposedLayers layers = compose(prepared, 0, parts.sinks());
    const LayerRange all{0, layers.grid().size[2] - 1};
    if (has_page) {
        if (!is_one_body(prepared)) watch_all(watchers, layers.grid(), prepared.any_job());
        const Stopwatch since_layers;
        make_tray_layers(
            layers, all, [](int, const io::LayerRuns&) {}, watchers, progress);
        parts.write(layers, {since_layers.total(), 0, 0}, report, progress);
    }
    progress.begin_stage(name_of(Phase::report), 0);
    const std::vector<Overlap> overlaps =
        overlaps_of(prepared, 0, has_page ? layers.overlapped() : layers.overlapped(all.first, all.last + 1));
    const std::vector<std::string> notes = overlap_notes(prepared, 0, overlaps);
    for (const std::string& note : notes) progress.warn(note);
    std::string json = tray_json(prepared, 0, overlaps, stack);
    io::write_whole_file(options.out / tray_file_name, json);
    report.write({options.out, 0, prepared.any_job(), stack, layers.grid(), notes, {}}, watchers, watch.total(),
                 progress);
    progress.end_stage();
    return {std::move(json), tray_summary(prepared, 0, stack, watch.total(), options.out),
            exit_code_of(tray, {}, verdicts_of(prepared))};
}

}  // namespace voxtone::slicer
