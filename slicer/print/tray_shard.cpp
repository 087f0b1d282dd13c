// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/tray_shard.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/files/json_object.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/part/phase.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/plate/part_reports.h"
#include "slicer/plate/tray_record.h"
#include "slicer/plate/tray_report.h"
#include "slicer/print/run_shard.h"
#include "slicer/print/shard_cut.h"

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
        if (!part.alone.empty() && part.ready) {
            const WarningsOfPart of_part(progress, part.part.name);
            part.ready->print->prepare(progress);
        }
}

PreparedTray prepare_for_shards(const OpenedTray& tray, Progress& progress) {
    PreparedTray prepared = prepare_tray(tray, progress);
    expect_shardable(prepared.any_job());
    if (prepared.any_job().outputs().gcvf)
        throw UsageError(
            fmt::format("--shard: {} of a tray is not made in shards: leave it out of --formats, or slice "
                        "without --shard",
                        io::gcvf_name));
    take_loops(prepared, progress);
    return prepared;
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

/// As the parts' own reports and the layers tell.
JobResult tell_of_tray(const MergeOptions& options, const io::StackDescription& stack, const Stopwatch& watch,
                       Progress& progress) {
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
        if (!is_one_body(prepared)) watchers.watch(all, layers.grid(), prepared.any_job());
        JobMeasurements made;
        make_layers(
            layers, all, [](int, const io::LayerRuns&) {}, watchers, made, progress);
        made.encode_s = 0;  // nothing is written
        parts.write(layers, made, report, progress);
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
            exit_code_of(tray, {}, verdicts_of(prepared)), failure_of(prepared)};
}

}  // namespace

JobResult run_tray_shard(const SliceOptions& asked, const TrayModels& models, Progress& progress) {
    if (!asked.overwrite && !models.empty()) io::expect_free_for_stack(asked.out);
    const OpenedTray tray = open_shard_of_tray(with_plan(asked, models));
    std::optional<PreparedTray> prepared;
    std::unique_ptr<const ComposedLayers> layers;
    const auto make = [&](const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers,
                          JobMeasurements& figures) { make_layers(*layers, mine, take, watchers, figures, progress); };
    const auto prepare = [&](bool) -> ShardedPrint {
        prepared = prepare_for_shards(tray, progress);
        layers.reset(new ComposedLayers(compose(*prepared, 0)));
        return {.job = prepared->any_job(),
                .identity = prepared->identity,
                .grid = layers->grid(),
                .layers = {0, layers->grid().size[2] - 1},
                .slab_layers = layers->slab_layers(),
                .work = slab_work_of(*prepared, layers->slab_layers()),
                .members = members_of(*prepared, 0),
                .make = make};
    };
    return run_shard(tray.job, {prepare}, progress);
}

MergedTelling telling_of_tray(const MergeOptions& options, Progress& progress) {
    return {[&](const io::ShardSet& shards) { return is_told(options.out, shards.stack); },
            [&, watch = Stopwatch()](const io::ShardSet& shards) {
                return tell_of_tray(options, shards.stack, watch, progress);
            }};
}

}  // namespace voxtone::slicer
