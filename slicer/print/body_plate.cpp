// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/body_plate.h"

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/process_usage.h"
#include "base/stop_deadline.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/files/json_object.h"
#include "io/layers/layer_stack_writer.h"
#include "io/layers/stack_folder.h"
#include "io/profiles/lamp_file.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/phase.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/part/prepared_body.h"
#include "slicer/part/report_files.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/output_folder.h"
#include "slicer/plate/prepared_job.h"
#include "slicer/plate/printer_page.h"
#include "slicer/plate/slice_report.h"
#include "slicer/print/estimate_job.h"
#include "slicer/print/estimate_text.h"
#include "slicer/print/shard_cut.h"

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

/// As the first shard left it.
std::optional<JobBody> kept_body(const OpenedJob& job) {
    const std::filesystem::path& out = job.options.out;
    std::optional<JobBody> kept = read_prepared(out, recorded_identity(io::shards_folder(out)).value_or(""));
    if (kept && job.options.strict && !kept->warnings.empty()) kept.reset();  // one may be a reason to stop
    return kept;
}

class BodyPlate final : public Plate {
public:
    BodyPlate(OpenedJob opened, bool is_shard) : opened_(std::move(opened)) {
        if (!is_shard) LoopCheckpoint::refuse_loss(opened_.options.out, opened_.run.goes_on, opened_.options.overwrite);
    }

    [[nodiscard]] const OpenedJob& job() const override { return opened_; }

    io::StackFolder take_folder(Progress& progress) override {
        return take_output(opened_.options.out, {io::shards_name}, progress);
    }

    std::optional<JobResult> done_before(const io::StackFolder& folder, Progress& progress) override {
        auto done = slicer::done_before(opened_, folder, progress);
        if (done) hand_over(folder.path(), opened_.options.for_printer, opened_.options.overwrite, progress);
        return done;
    }

    void expect_replaceable(const io::StackFolder& folder, Progress& progress) override {
        const ResolvedJob& options = opened_.options;
        const bool goes_on = opened_.run.goes_on && has_checkpoint(folder);
        slicer::expect_replaceable(opened_, folder, {options.overwrite, goes_on, options.for_printer}, progress);
        expect_resumable(opened_, folder, progress);
    }

    void prepare(Progress& progress) override {
        make_ready(std::nullopt, progress);
        expect_enough_layers(*ready_, progress);
        // Without hard links OUT/printer is a copy.
        const ResolvedJob& options = ready_->job.options;
        const std::uint64_t copies = io::has_hard_links(options.out) ? 1 : 2;
        expect_disk_space(options.out, copies * ready_->plan.disk_bytes, progress);
        expect_stages(progress, expected_stages(ready_->plan.phases));
        ready_->print->prepare(progress);
        announce(*ready_, progress);
    }

    std::optional<JobResult> rearrange(Progress& progress) override {
        ready_->print->rearrange(progress);
        const ResolvedJob& options = ready_->job.options;
        const bool is_end = options.until == Until::loop;
        // Beside the stack it is for another job of this body. One that was left out is no work to spare.
        if (!is_end && (!options.keep_loop || options.loop.iterations == 0)) return std::nullopt;
        JobResult kept = ready_->print->keep_loop();
        forget_checkpoint();
        return is_end ? std::optional(std::move(kept)) : std::nullopt;
    }

    JobResult print(io::StackFolder folder, const Stopwatch& since_begin, Progress& progress) override {
        const OpenedJob& job = ready_->job;
        const JobPlan& plan = ready_->plan;
        const LayerRange& range = plan.layers;
        io::LayerStackWriter writer(std::move(folder), job.describe(plan.grid, range), job.outputs());
        LayerWatchers watchers;
        if (job.options.report) watchers.watch(range, plan.grid, job);
        const auto write = [&](int k, const io::LayerRuns& layer) {
            writer.write(std::uint32_t(k - range.first), layer);
        };
        make_layers(*ready_->print, range, write, watchers, ready_->figures, progress);
        const io::StackDescription& stack = finish(writer, progress);
        forget_checkpoint();

        ready_->print->evaluate(stack, progress);
        progress.begin_stage(name_of(Phase::report), 0);
        io::Report report = make_report(job, ready_->body, stack, *ready_->print, ready_->figures);
        if (watchers.thumbnails) report.layers = watchers.thumbnails->take();
        JobResult told = write_report(job, *ready_->print, report, watchers.voxels, since_begin, progress);
        progress.end_stage();
        return told;
    }

    void expect_loops(Progress& progress) override { expect_own_loop(opened_, &progress); }

    ShardedPrint prepare_for_shards(bool same_job_before, Progress& progress) override {
        std::optional<JobBody> kept = same_job_before ? kept_body(opened_) : std::nullopt;
        const bool is_kept = kept.has_value();
        make_ready(std::move(kept), progress);
        const OpenedJob& job = ready_->job;
        const JobPlan& plan = ready_->plan;
        check_layer_count(plan.grid.size[2], job.printer, "larger (--size), or thicker (--thickness)");
        ready_->print->prepare(progress);
        const int slab_layers = ready_->print->layers()->slab_layers();
        return {.job = job,
                .identity = ready_->identity,
                .grid = plan.grid,
                .layers = plan.layers,
                .slab_layers = slab_layers,
                .work = slab_work(ready_->body, job.options.colour.depth_mm, slab_layers),
                .body = &ready_->body,
                .make =
                    [this, &progress](const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers,
                                      JobMeasurements& figures) {
                        std::vector<ExpectedStage> stages = expected_stages(ready_->plan.phases, {Phase::layers});
                        for (ExpectedStage& stage : stages)
                            stage.seconds *= double(mine.layers()) / ready_->plan.layers.layers();
                        expect_stages(progress, std::move(stages));
                        make_layers(*ready_->print, mine, take, watchers, figures, progress);
                    },
                .expect_disk =
                    [this, &progress](const LayerRange& mine) {
                        expect_disk_space(ready_->job.options.out, disk_bytes(ready_->job, ready_->body, mine, {}),
                                          progress);
                    },
                .keep =
                    [this, is_kept] {
                        if (!is_kept) keep_prepared(ready_->job.options.out, ready_->identity.job, ready_->body);
                    }};
    }

private:
    void make_ready(std::optional<JobBody> kept, Progress& progress) {
        for (const std::string& warning : opened_.printer.warnings()) progress.warn(warning);
        if (const auto doubt = io::lamp_doubt(opened_.options.resins, opened_.options.illuminant))
            progress.warn(*doubt);
        ready_.emplace(opened_, std::move(kept), progress);
    }

    void forget_checkpoint() const {
        LoopCheckpoint::remove_from(opened_.options.out);
        set_stop_advice({});
    }

    const io::StackDescription& finish(io::LayerStackWriter& writer, Progress& progress) {
        const Stopwatch watch;
        progress.begin_stage(name_of(Phase::finish), 0);
        const BodyPreview preview(ready_->body, ready_->job.outputs().gcvf);
        const ResolvedJob& options = ready_->job.options;
        writer.add_file(job_file_name, job_record(options.raw, ready_->identity.inputs, options.out));
        const std::string title = fs::path(options.model).filename().string();
        const io::StackDescription& stack = writer.finish(
            preview.mesh(), &progress, printer_page(ready_->job, title, {{title, ready_->body, {{0, 0, 0}}}}));
        ready_->figures.layer_bytes = writer.bytes_written();
        hand_over(options.out, options.for_printer, options.overwrite, progress);
        progress.end_stage();
        ready_->figures.finish_s = watch.total();
        return stack;
    }

    const OpenedJob opened_;
    std::optional<PreparedJob> ready_;
};

}  // namespace

std::unique_ptr<Plate> body_plate(const SliceOptions& requested, Progress& progress) {
    const bool is_shard = !requested.shard.empty();
    return std::make_unique<BodyPlate>(open_job(requested,
                                                [&](const OpenedJob& job, JobRun& run) {
                                                    // What is seen of shards is the merged stack's to say.
                                                    if (is_shard)
                                                        run.why_unpredicted = "A part of the layers is not predicted.";
                                                    else
                                                        go_on_with_own_loop(job, run, progress);
                                                }),
                                       is_shard);
}

}  // namespace voxtone::slicer
