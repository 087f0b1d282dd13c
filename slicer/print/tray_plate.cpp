// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/tray_plate.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_stack_writer.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/plate/output_folder.h"
#include "slicer/plate/part_reports.h"
#include "slicer/plate/printer_page.h"
#include "slicer/plate/tray_record.h"
#include "slicer/plate/tray_report.h"
#include "slicer/print/shard_cut.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

io::StackFolder take_tray_folder(const fs::path& out, Progress& progress) {
    return take_output(out, {tray_file_name, tray_picture_name, io::shards_name}, progress);
}

/// Where the tray goes besides, numbered like its folder; empty: nowhere.
fs::path printer_target(const OpenedTray& tray, int number) {
    const fs::path target = tray.plan.common.for_printer;
    if (target.empty()) return target;
    const fs::path kind = target.extension();
    if (kind != ".zip" && kind != ".gcvf") return folder_of_tray(target, number);
    return folder_of_tray(fs::path(target).replace_extension(), number).string() + kind.string();
}

/// This very tray, with every part that can be made.
std::optional<JobResult> done_before(const OpenedTray& tray, const io::StackFolder& folder, const Progress& progress) {
    if (tray.plan.common.overwrite) return std::nullopt;
    std::optional<std::string> json = said_before(tray.job, folder, tray_file_name, progress);
    const std::optional<TrayEnding> ending = ending_in(folder.path());
    if (!json || !ending || !ending->failed.empty()) return std::nullopt;
    return JobResult{*std::move(json),
                     fmt::format("{}: holds this tray already, whole; nothing was done (--overwrite makes it again)\n",
                                 folder.path().string()),
                     exit_code_of(tray, {}, ending->verdicts)};
}

/// Folders of parts that this tray has no more go to OUT/parts/earlier, where they are found again (tray_parts.h).
void set_aside_left_parts(const OpenedTray& tray, const PreparedTray& prepared, Progress& progress) {
    const fs::path parts = fs::path(tray.plan.common.out) / io::parts_name;
    if (std::error_code none; !fs::is_directory(parts, none)) return;
    std::set<std::string> names{std::string(earlier_parts_name)};
    for (const ReadyPart& part : prepared.parts.ready) names.insert(part.part.name);
    for (const FailedPart& part : prepared.parts.failed) names.insert(part.name);
    std::vector<fs::path> left;
    for (const fs::directory_entry& entry : fs::directory_iterator(parts))
        if (entry.is_directory() && !names.contains(entry.path().filename().string())) left.push_back(entry.path());
    std::ranges::sort(left);
    std::string said;
    for (const fs::path& folder : left) {
        const fs::path aside = parts / earlier_parts_name / folder.filename();
        fs::create_directories(aside.parent_path());
        fs::remove_all(aside);
        fs::rename(folder, aside);
        said += (said.empty() ? "" : ", ") + folder.filename().string();
    }
    if (!said.empty())
        progress.note(
            fmt::format("{}: of an earlier tray, and set aside in {}", said, (parts / earlier_parts_name).string()));
}

void expect_tray_replaceable(const OpenedTray& tray, int number, const io::StackFolder& folder, Progress& progress) {
    expect_replaceable(tray.job, folder, {tray.plan.common.overwrite, false, printer_target(tray, number)}, progress);
}

/// The page of the tray's printer folder.
io::PageOfStack page_of(const PreparedTray& prepared, int number) {
    std::vector<PlacedBody> bodies;
    for (const ReadyPart& part : prepared.parts.ready) {
        std::vector<std::array<int, 3>> at;
        for (const PlacedCopy& copy : part.copies)
            if (copy.tray == number) at.push_back(copy.at);
        if (!at.empty() && part.ready && !part.is_joined && !part.part.cuts)
            bodies.push_back({part.part.name, part.ready->body, std::move(at)});
    }
    std::size_t copies = 0;
    for (const PlacedBody& body : bodies) copies += body.at.size();
    std::string title = "a tray of " + counted(copies, "part");
    std::vector<std::string> missing;
    for (const FailedPart& part : prepared.parts.failed) missing.push_back(part.who());
    return printer_page(prepared.any_job(), std::move(title), std::move(bodies), std::move(missing));
}

/// One tray on its way from its layers to its files.
class TrayPrint {
public:
    TrayPrint(const OpenedTray& tray, PreparedTray& prepared, int number, io::StackFolder folder)
        : tray_(tray),
          prepared_(prepared),
          number_(number),
          out_(folder.path()),
          parts_(prepared, number, tray.plan.common.report),
          layers_(compose(prepared, number, parts_.sinks())),
          writer_(std::move(folder), any().describe(layers_.grid(), all()), any().outputs()) {
        if (tray.plan.common.report && !is_one_body(prepared)) watchers_.watch(all(), layers_.grid(), any());
    }

    /// Its layers, and the reports of the parts that are first seen in them.
    void make(TrayReport& report, Progress& progress) {
        JobMeasurements made;
        make_layers(
            layers_, all(), [&](int k, const io::LayerRuns& layer) { writer_.write(std::uint32_t(k), layer); },
            watchers_, made, progress);
        made.layer_bytes = writer_.bytes_written();
        parts_.write(layers_, made, report, progress);
    }

    /// Once all parts are told of: puts the stack in its place. What there is to read of it.
    [[nodiscard]] JobResult finish(TrayReport& report, const Stopwatch& watch, Progress& progress) {
        const std::vector<Overlap> overlaps = overlaps_of(prepared_, number_, layers_.overlapped());
        const std::vector<std::string> notes = overlap_notes(prepared_, number_, overlaps);
        for (const std::string& note : notes) progress.warn(note);
        progress.begin_stage(name_of(Phase::finish), 0);
        writer_.add_file(job_file_name, job_record(tray_.job.options.raw, prepared_.identity.inputs, out_));
        writer_.set_members(members_of(prepared_, number_));
        const io::StackDescription& stack = writer_.finish({}, &progress, page_of(prepared_, number_));
        std::string json = tray_json(prepared_, number_, overlaps, stack);
        io::write_whole_file(out_ / tray_file_name, json);
        hand_over(out_, printer_target(tray_, number_), tray_.plan.common.overwrite, progress);
        report.write({out_, number_, any(), stack, layers_.grid(), notes, prepared_.parts.failed}, watchers_,
                     watch.total(), progress);
        progress.end_stage();
        return {std::move(json), tray_summary(prepared_, number_, stack, watch.total(), out_), ExitCode::done};
    }

private:
    [[nodiscard]] const OpenedJob& any() const { return prepared_.any_job(); }
    [[nodiscard]] LayerRange all() const { return {0, layers_.grid().size[2] - 1}; }

    const OpenedTray& tray_;
    const PreparedTray& prepared_;
    int number_;
    fs::path out_;
    PartReports parts_;
    ComposedLayers layers_;
    io::LayerStackWriter writer_;
    LayerWatchers watchers_;
};

/// Of a tray that goes as far as the loops.
JobResult loops_kept(const OpenedTray& tray, const PreparedTray& prepared) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-tray-loops").add("version", 1).key("parts").begin_list();
    std::size_t looped = 0;
    for (const ReadyPart& part : prepared.parts.ready) {
        if (!part.ready) continue;
        json.value(part.part.name);
        ++looped;
    }
    return {json.end_list().end_object().text(),
            fmt::format("{}: what the loops of {} parts came to is kept\n",
                        (fs::path(tray.plan.common.out) / io::parts_name).string(), looped),
            exit_code_of(tray, prepared.parts.failed, {}), failure_of(prepared)};
}

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

/// Without hard links OUT/printer is a copy.
std::uint64_t disk_bytes_of(const PreparedTray& prepared, const fs::path& out) {
    std::uint64_t bytes = 0;
    for (const ReadyPart& part : prepared.parts.ready) bytes += part.disk_bytes(prepared.any_job());
    return bytes * (io::has_hard_links(out) ? 1 : 2);
}

class TrayPlate final : public Plate {
public:
    TrayPlate(SliceOptions asked, const TrayModels& models) : asked_(std::move(asked)), models_(models) {
        if (asked_.shard.empty()) return;
        if (!asked_.overwrite && !models.empty()) io::expect_free_for_stack(asked_.out);
        tray_.emplace(open_shard_of_tray(with_plan(asked_, models)));
    }

    [[nodiscard]] const OpenedJob& job() const override { return tray_->job; }

    /// A strange folder is refused before anything is made in it; whose stack is there is known once the plan is read.
    io::StackFolder take_folder(Progress& progress) override {
        io::StackFolder folder = take_tray_folder(asked_.out, progress);
        if (!asked_.overwrite && !folder.holds_stack()) folder.expect_free();
        tray_.emplace(open_tray(with_plan(asked_, models_)));
        for (const std::string& note : tray_->plan.notes) progress.note(note);
        return folder;
    }

    std::optional<JobResult> done_before(const io::StackFolder& folder, Progress& progress) override {
        if (only_loops()) return std::nullopt;
        auto done = slicer::done_before(*tray_, folder, progress);
        for (int number = 0; done && is_same_job(folder_of_tray(asked_.out, number), tray_->job, &progress); ++number)
            hand_over(folder_of_tray(asked_.out, number), printer_target(*tray_, number), asked_.overwrite, progress);
        return done;
    }

    void expect_replaceable(const io::StackFolder& folder, Progress& progress) override {
        expect_tray_replaceable(*tray_, 0, folder, progress);
    }

    void prepare(Progress& progress) override {
        prepared_.emplace(prepare_tray(*tray_, progress));
        const fs::path out = tray_->plan.common.out;
        for (int number = 1; number < prepared_->trays(); ++number) {
            further_.push_back(take_tray_folder(folder_of_tray(out, number), progress));
            expect_tray_replaceable(*tray_, number, further_.back(), progress);
        }
        expect_disk_space(out, disk_bytes_of(*prepared_, out), progress);
    }

    std::optional<JobResult> rearrange(Progress& progress) override {
        rearrange_parts(*tray_, *prepared_, progress);
        return only_loops() ? std::optional(loops_kept(*tray_, *prepared_)) : std::nullopt;
    }

    JobResult print(io::StackFolder folder, const Stopwatch& since_begin, Progress& progress) override {
        TrayReport report = report_for(*prepared_, tray_->plan.common.out);
        std::vector<std::unique_ptr<TrayPrint>> prints;
        for (int number = 0; number < prepared_->trays(); ++number) {
            io::StackFolder& taken = number == 0 ? folder : further_[std::size_t(number - 1)];
            prints.push_back(std::make_unique<TrayPrint>(*tray_, *prepared_, number, std::move(taken)));
            prints.back()->make(report, progress);
        }
        set_aside_left_parts(*tray_, *prepared_, progress);
        JobResult result;
        for (const auto& print : prints) {
            JobResult made = print->finish(report, since_begin, progress);
            if (print == prints.front()) result.json = std::move(made.json);
            result.text += made.text;
        }
        result.exit_code = exit_code_of(*tray_, prepared_->parts.failed, verdicts_of(*prepared_));
        result.failure = failure_of(*prepared_);
        return result;
    }

    ShardedPrint prepare_for_shards(bool, Progress& progress) override {
        prepared_.emplace(prepare_tray(*tray_, progress));
        if (prepared_->any_job().outputs().gcvf)
            throw UsageError(
                fmt::format("--shard: {} of a tray is not made in shards: leave it out of --formats, or slice "
                            "without --shard",
                            io::gcvf_name));
        take_loops(*prepared_, progress);
        layers_.reset(new ComposedLayers(compose(*prepared_, 0)));
        const LayerRange all{0, layers_->grid().size[2] - 1};
        return {
            .job = prepared_->any_job(),
            .identity = prepared_->identity,
            .grid = layers_->grid(),
            .layers = all,
            .slab_layers = layers_->slab_layers(),
            .work = slab_work_of(*prepared_, layers_->slab_layers()),
            .members = members_of(*prepared_, 0),
            .make = [this, &progress](
                        const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers,
                        JobMeasurements& figures) { make_layers(*layers_, mine, take, watchers, figures, progress); },
            .expect_disk =
                [this, all, &progress](const LayerRange& mine) {
                    const fs::path out = tray_->plan.common.out;
                    const std::uint64_t whole = disk_bytes_of(*prepared_, out);
                    expect_disk_space(out, whole * std::uint64_t(mine.layers()) / std::uint64_t(all.layers()),
                                      progress);
                }};
    }

private:
    [[nodiscard]] bool only_loops() const { return asked_.until == name_of(Until::loop); }

    const SliceOptions asked_;
    const TrayModels models_;
    std::optional<OpenedTray> tray_;
    std::optional<PreparedTray> prepared_;
    std::vector<io::StackFolder> further_;  ///< of trays after the first
    std::unique_ptr<const ComposedLayers> layers_;
};

}  // namespace

void take_loops(PreparedTray& prepared, Progress& progress) {
    for (ReadyPart& part : prepared.parts.ready)
        if (!part.alone.empty() && part.ready) {
            const WarningsOfPart of_part(progress, part.part.name);
            part.ready->print->prepare(progress);
        }
}

OpenedTray open_shard_of_tray(const SliceOptions& asked) {
    if (asked.trays > 1) throw UsageError("--shard: is of one tray; leave --trays out");
    OpenedTray tray = open_tray(asked);
    tray.plan.common.fail_fast = true;
    return tray;
}

std::unique_ptr<Plate> tray_plate(const SliceOptions& asked, const TrayModels& models) {
    return std::make_unique<TrayPlate>(asked, models);
}

}  // namespace voxtone::slicer
