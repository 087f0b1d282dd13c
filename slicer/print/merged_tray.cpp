// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/merged_tray.h"

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
#include "slicer/print/tray_plate.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

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

MergedTelling telling_of_tray(const MergeOptions& options, Progress& progress) {
    return {[&](const io::ShardSet& shards) { return is_told(options.out, shards.stack); },
            [&, watch = Stopwatch()](const io::ShardSet& shards) {
                return tell_of_tray(options, shards.stack, watch, progress);
            }};
}

}  // namespace voxtone::slicer
