// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/slice_job.h"

#include <array>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/stop_deadline.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/files/json_object.h"
#include "io/layers/layer_stack_writer.h"
#include "io/layers/stack_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/phase.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/part/report_files.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/output_folder.h"
#include "slicer/plate/prepared_job.h"
#include "slicer/plate/printer_page.h"
#include "slicer/plate/slice_report.h"
#include "slicer/print/estimate_job.h"
#include "slicer/print/estimate_text.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

bool has_checkpoint(const io::StackFolder& folder) { return fs::exists(folder.path() / io::checkpoint_name); }

/// The same command again goes on with its interrupted loop. Not where no loop is asked for, which the saved one would
/// be printed as.
void go_on_with_own_loop(const OpenedJob& job, JobRun& run, Progress& progress) {
    const ResolvedJob& options = job.options;
    if (options.resume || options.overwrite || options.loop.iterations == 0) return;
    if (std::error_code none; !fs::exists(options.out / io::checkpoint_name, none)) return;
    LoopCheckpoint::expect_same_job(options.out, opened_loop_identity(job, &progress));
    run.goes_on = true;
    progress.note(
        fmt::format("{} holds the interrupted appearance loop of this very job: it goes on (--overwrite "
                    "begins anew)",
                    options.out.string()));
}

/// The verdict's sentence where the report's figures say that it is bad; one that cannot be read says nothing.
std::string bad_verdict(const std::string& json, const fs::path& figures) {
    try {
        const io::JsonObject report = io::JsonObject::parse(json, figures.string());
        if (!report.is_object("verdict")) return {};
        const io::JsonObject verdict = report.object("verdict");
        const bool is_bad = verdict.has("level") && verdict.text("level") == name_of(io::VerdictLevel::bad);
        return is_bad && verdict.has("sentence") ? verdict.text("sentence") : std::string();
    } catch (const InputError&) {
        return {};
    }
}

/// What was said when this very job was done, where nothing is left of it to do.
std::optional<JobResult> done_before(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    if (job.options.overwrite || job.options.until != Until::end || has_checkpoint(folder)) return std::nullopt;
    std::optional<std::string> json = said_before(job, folder, report_file::figures, progress);
    if (!json) return std::nullopt;
    const std::string bad = bad_verdict(*json, folder.path() / report_file::figures);
    return JobResult{*std::move(json),
                     fmt::format("{}: holds this job's stack already, whole; nothing was done (--overwrite makes it "
                                 "again)\n{}",
                                 folder.path().string(), bad.empty() ? "" : "  " + bad + "\n"),
                     !bad.empty() && job.options.strict ? ExitCode::check_failed : ExitCode::done};
}

/// A saved loop of another job is refused before the model is read.
void expect_resumable(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    expect_own_loop(job, &progress);
    if (!job.run.goes_on || !has_checkpoint(folder)) return;
    LoopCheckpoint::expect_same_job(folder.path(), opened_loop_identity(job, &progress));
    set_stop_advice(LoopCheckpoint::advice(folder.path()));
}

/// As `verify` will ask. A part of a body that has enough layers may have fewer, and is warned about.
void expect_enough_layers(const PreparedJob& ready, Progress& progress) {
    const PrinterProfile& printer = ready.job.printer;
    const int all = ready.plan.grid.size[2], made = ready.plan.layers.layers();
    check_layer_count(all, printer, enough_layers(ready.body));
    if (made < printer.min_layers)
        progress.warn(named_warning(
            "few-layers",
            fmt::format("these {} layers are a part of {}; {} takes no fewer than {}: lay the parts together before "
                        "they are printed or verified",
                        made, all, printer.id, printer.min_layers)));
}

/// Says what the job will take (`voxtone estimate` says more).
void announce(const PreparedJob& ready, Progress& progress) {
    const double read_s = ready.figures.read_s + ready.figures.repair_s;
    const PhaseEstimate read{Phase::read, read_s, read_s, peak_memory_bytes(), true};
    const auto made_with = ready.print->made_with();
    const JobEstimate estimate =
        estimate_print({ready.job, ready.body, ready.plan}, read, made_with ? &*made_with : nullptr, progress);
    progress.note(estimate_summary(estimate));
    if (const std::string advice = loop_advice(estimate); !advice.empty() && !ready.job.run.goes_on)
        progress.note(advice);
}

/// The end of a job that goes as far as the loop.
JobResult keep_loop(const PreparedJob& ready, Progress& progress) {
    ready.print->rearrange(progress);
    JobResult kept = ready.print->keep_loop();
    LoopCheckpoint::remove_from(ready.job.options.out);
    set_stop_advice({});
    return kept;
}

/// Beside the stack, for another job of this body. One that was left out is no work to spare.
void keep_loop_besides(const PreparedJob& ready) {
    const ResolvedJob& options = ready.job.options;
    if (!options.keep_loop || options.loop.iterations == 0) return;
    (void)ready.print->keep_loop();
    LoopCheckpoint::remove_from(options.out);
    set_stop_advice({});
}

const io::StackDescription& finish_stack(PreparedJob& ready, io::LayerStackWriter& writer, Progress& progress) {
    const Stopwatch watch;
    progress.begin_stage(name_of(Phase::finish), 0);
    const BodyPreview preview(ready.body, ready.job.outputs().gcvf);
    const ResolvedJob& options = ready.job.options;
    writer.add_file(job_file_name, job_record(options.raw, ready.identity.inputs, options.out));
    const std::string title = fs::path(options.model).filename().string();
    const io::StackDescription& stack =
        writer.finish(preview.mesh(), &progress, printer_page(ready.job, title, {{title, ready.body, {{0, 0, 0}}}}));
    ready.figures.layer_bytes = writer.bytes_written();
    hand_over(options.out, options.for_printer, options.overwrite, progress);
    progress.end_stage();
    ready.figures.finish_s = watch.total();
    return stack;
}

}  // namespace

JobResult run_slice_job(const SliceOptions& requested, Progress& progress) {
    const Stopwatch watch;
    // All that can refuse the job, from what costs nothing to what costs most ...
    const OpenedJob opened =
        open_job(requested, [&](const OpenedJob& job, JobRun& run) { go_on_with_own_loop(job, run, progress); });
    VOXTONE_EXPECT(!opened.options.sharded);
    LoopCheckpoint::refuse_loss(opened.options.out, opened.run.goes_on, opened.options.overwrite);
    // From here on the output folder is this job's; what it holds stays until the new stack is whole.
    io::StackFolder folder = take_output(opened.options.out, {io::shards_name}, progress);
    if (auto done = done_before(opened, folder, progress)) {
        hand_over(folder.path(), opened.options.for_printer, opened.options.overwrite, progress);
        return *std::move(done);
    }
    expect_replaceable(
        opened, folder,
        {opened.options.overwrite, opened.run.goes_on && has_checkpoint(folder), opened.options.for_printer}, progress);
    expect_resumable(opened, folder, progress);
    const ThreadLimit threads(static_cast<std::size_t>(opened.options.threads));
    for (const std::string& warning : opened.printer.warnings()) progress.warn(warning);
    PreparedJob ready(opened, std::nullopt, progress);
    const auto& [figures, body, identity, job, plan, print] = ready;
    expect_enough_layers(ready, progress);
    // Without hard links OUT/printer is a copy.
    const std::uint64_t copies = io::has_hard_links(job.options.out) ? 1 : 2;
    expect_disk_space(job.options.out, copies * plan.disk_bytes, progress);
    expect_stages(progress, expected_stages(plan.phases));
    print->prepare(progress);
    announce(ready, progress);

    // ... and from here on hours may be spent.
    if (job.options.until == Until::loop) return keep_loop(ready, progress);
    const LayerRange& range = plan.layers;
    io::LayerStackWriter writer(std::move(folder), job.describe(plan.grid, range), job.outputs());
    print->rearrange(progress);
    keep_loop_besides(ready);
    LayerWatchers watchers;
    if (job.options.report) watchers.watch(range, plan.grid, job);
    const auto write = [&](int k, const io::LayerRuns& layer) { writer.write(std::uint32_t(k - range.first), layer); };
    make_layers(*print, range, write, watchers, ready.figures, progress);
    const io::StackDescription& stack = finish_stack(ready, writer, progress);
    LoopCheckpoint::remove_from(job.options.out);
    set_stop_advice({});

    print->evaluate(stack, progress);
    progress.begin_stage(name_of(Phase::report), 0);
    io::Report report = make_report(job, body, stack, *print, figures);
    if (watchers.thumbnails) report.layers = watchers.thumbnails->take();
    std::string json = write_report(job, *print, report, watchers.voxels, watch, progress);
    progress.end_stage();
    const bool bad = report.verdict && report.verdict->level == io::VerdictLevel::bad;
    return {std::move(json), summary_text(*print, report, watch.total(), job.options.report, writer.folder()),
            bad && job.options.strict ? ExitCode::check_failed : ExitCode::done,
            bad ? std::optional(report.verdict->sentence) : std::nullopt};
}

}  // namespace voxtone::slicer
