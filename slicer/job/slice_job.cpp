// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/job/slice_job.h"

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/peak_memory.h"
#include "base/stop_deadline.h"
#include "base/stopwatch.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_stack_writer.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/estimate/estimate_job.h"
#include "slicer/estimate/estimate_text.h"
#include "slicer/estimate/phase_estimates.h"
#include "slicer/job/job_phases.h"
#include "slicer/job/slice_report.h"
#include "slicer/kept/job_identity.h"
#include "slicer/kept/loop_checkpoint.h"
#include "slicer/kept/report_files.h"
#include "slicer/look/thumbnails.h"
#include "slicer/options/job_file.h"
#include "slicer/prepare/job_body.h"
#include "slicer/prepare/opened_job.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// Whether the folder holds this very job's stack, whole, though perhaps without its report.
bool holds_this_stack(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    return folder.holds_stack() && is_same_job(folder.path(), job, &progress);
}

bool has_checkpoint(const io::StackFolder& folder) { return fs::exists(folder.path() / io::checkpoint_name); }

/// What was said when this very job was done, where nothing is left of it to do.
std::optional<SliceResult> done_before(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    const fs::path figures = folder.path() / report_file::figures;
    if (job.options.overwrite || job.options.until != Until::end || has_checkpoint(folder) || !fs::exists(figures) ||
        !holds_this_stack(job, folder, progress))
        return std::nullopt;
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
    const std::vector<std::uint8_t> json = io::read_whole_file(figures, most_bytes);
    const auto report = nlohmann::json::parse(json, nullptr, false);
    const auto level = nlohmann::json::json_pointer("/verdict/level");
    const bool bad = report.is_object() && report.contains(level) && report[level] == name_of(io::VerdictLevel::bad);
    return SliceResult{{json.begin(), json.end()},
                       fmt::format("{}: holds this job's stack already, whole; nothing was done (--overwrite makes it "
                                   "again)\n",
                                   folder.path().string()),
                       bad && job.options.strict ? ExitCode::check_failed : ExitCode::done};
}

/// Another job's stack, and whatever else is no job's of this folder, is replaced only where that was allowed.
void expect_replaceable(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    const bool goes_on = job.options.resume && has_checkpoint(folder);
    if (!job.options.overwrite && !goes_on && !holds_this_stack(job, folder, progress)) folder.expect_free();
    if (!job.options.overwrite) expect_no_other_shards(job, &progress);
}

/// A saved loop of another job is refused before the model is read.
void expect_resumable(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    expect_own_loop(job, &progress);
    if (job.options.resume && has_checkpoint(folder))
        LoopCheckpoint::expect_same_job(folder.path(), opened_loop_identity(job, &progress));
}

/// As `verify` will ask. A part of a body that has enough layers may have fewer, and is warned about.
void expect_enough_layers(const OpenedJob& job, const JobBody& body, const LayerRange& range, Progress& progress) {
    check_layer_count(body.grid.size[2], job.printer,
                      body.is_picture ? "thicker (--thickness)" : "larger (--size), or turn it (--rotate)");
    if (range.layers() < job.printer.min_layers)
        progress.warn(fmt::format(
            "these {} layers are a part of {}; {} takes no fewer than {}: lay the parts together before they are "
            "printed or verified",
            range.layers(), body.grid.size[2], job.printer.id, job.printer.min_layers));
}

/// Says what the job will take (`voxtone estimate` says more).
void announce(const OpenedJob& job, const JobBody& body, const LayerRange& range, const JobMeasurements& figures,
              const Print& print, Progress& progress) {
    const double read_s = figures.read_s + figures.repair_s;
    const ReadBody read{{"read and repair", read_s, read_s, peak_memory_bytes(), true}, resident_bytes()};
    const auto made_with = print.made_with();
    const JobEstimate estimate = estimate_print(job, body, range, read, made_with ? &*made_with : nullptr, progress);
    progress.note(estimate_summary(estimate));
    if (const std::string advice = loop_advice(estimate); !advice.empty() && !job.options.resume) progress.note(advice);
}

/// The printed body for a container's preview.
std::vector<std::array<float, 3>> single_precision(const std::vector<Eigen::Vector3d>& positions) {
    std::vector<std::array<float, 3>> out;
    out.reserve(positions.size());
    for (const Eigen::Vector3d& p : positions) out.push_back({float(p.x()), float(p.y()), float(p.z())});
    return out;
}

/// The end of a job that goes as far as the loop.
SliceResult keep_loop(const OpenedJob& job, Print& print, Progress& progress) {
    print.rearrange(progress);
    JobResult kept = print.keep_loop();
    LoopCheckpoint::remove_from(job.options.out);
    set_stop_advice({});
    return {std::move(kept.json), std::move(kept.text), kept.exit_code};
}

const io::StackDescription& finish_stack(const OpenedJob& job, const JobBody& body, const JobIdentity& identity,
                                         io::LayerStackWriter& writer, JobMeasurements& figures, Progress& progress) {
    const Stopwatch watch;
    progress.begin_stage("finish", 0);
    std::vector<std::array<float, 3>> positions;
    if (job.outputs().gcvf) positions = single_precision(body.solid->positions_mm);
    io::PreviewMesh preview;
    if (!positions.empty()) preview = {positions, body.solid->triangles};
    writer.add_file(job_file_name, job_record(job.options.asked, identity.inputs, job.options.out));
    const io::StackDescription& stack = writer.finish(preview, &progress);
    figures.layer_bytes = writer.bytes_written();
    progress.end_stage();
    figures.finish_s = watch.total();
    return stack;
}

}  // namespace

SliceResult run_slice_job(const SliceOptions& asked, Progress& progress) {
    const Stopwatch watch;
    JobMeasurements figures;
    // All that can refuse the job, from what costs nothing to what costs most ...
    OpenedJob job = open_job(asked);
    VOXTONE_EXPECT(!job.options.sharded);
    LoopCheckpoint::refuse_loss(job.options.out, job.options.resume, job.options.overwrite);
    // From here on the output folder is this job's; what it holds stays until the new stack is whole.
    std::vector<std::string_view> companions(report_file::all.begin(), report_file::all.end());
    companions.push_back(io::shards_name);
    io::StackFolder folder(job.options.out, std::move(companions));
    if (auto done = done_before(job, folder, progress)) return *std::move(done);
    expect_replaceable(job, folder, progress);
    expect_resumable(job, folder, progress);
    const ThreadLimit threads(static_cast<std::size_t>(job.options.threads));
    for (const std::string& warning : job.printer.warnings()) progress.warn(warning);
    const JobBody body = read_body(job, figures, progress);
    const JobIdentity identity = identify_said(job, body, progress);
    load_best_resins(job, body, progress);
    const LayerRange range = range_within(job.options.layers, body.grid.size[2]);
    expect_enough_layers(job, body, range, progress);
    expect_disk_space(job, body, range, progress);
    expect_stages(progress, expected_stages(phase_estimates(job, body, range, thread_count(), resident_bytes())));
    const std::unique_ptr<Print> print = make_print(job, body, identity, progress);
    print->prepare(progress);
    announce(job, body, range, figures, *print, progress);

    // ... and from here on hours may be spent.
    if (job.options.until == Until::loop) return keep_loop(job, *print, progress);
    io::LayerStackWriter writer(std::move(folder), job.describe(body.grid, range), job.outputs());
    print->rearrange(progress);
    LayerWatchers watchers;
    if (job.options.report) {
        watchers.thumbnails.emplace(range.first, range.layers(), body.grid, job.palette());
        watchers.voxels.emplace(range.first, range.layers(), body.grid);
    }
    const auto write = [&](int k, const io::LayerRuns& layer) { writer.write(std::uint32_t(k - range.first), layer); };
    make_layers(*print, range, write, watchers, figures, progress);
    const io::StackDescription& stack = finish_stack(job, body, identity, writer, figures, progress);
    LoopCheckpoint::remove_from(job.options.out);
    set_stop_advice({});

    print->look(stack, progress);
    progress.begin_stage("report", 0);
    io::Report report = make_report(job, body, stack, *print, figures);
    if (watchers.thumbnails) report.layers = watchers.thumbnails->take();
    std::string json = write_report(job, *print, report, watchers.voxels, watch, progress);
    progress.end_stage();
    const bool bad = report.verdict && report.verdict->level == io::VerdictLevel::bad;
    return {std::move(json), summary_text(*print, report, watch.total(), job.options.report, writer.folder()),
            bad && job.options.strict ? ExitCode::check_failed : ExitCode::done};
}

}  // namespace voxtone::slicer
