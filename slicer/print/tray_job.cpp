// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/tray_job.h"

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
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_stack_writer.h"
#include "io/layers/stack_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/plate/output_folder.h"
#include "slicer/plate/part_reports.h"
#include "slicer/plate/printer_page.h"
#include "slicer/plate/tray_record.h"
#include "slicer/plate/tray_report.h"

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

}  // namespace

JobResult run_tray_job(const SliceOptions& asked, const TrayModels& models, Progress& progress) {
    const Stopwatch watch;
    const bool only_loops = asked.until == name_of(Until::loop);
    // A strange folder is refused before anything is made in it; whose stack is there is known once the plan is read.
    io::StackFolder first = take_tray_folder(asked.out, progress);
    if (!asked.overwrite && !first.holds_stack()) first.expect_free();
    const OpenedTray tray = open_tray(with_plan(asked, models));
    for (const std::string& note : tray.plan.notes) progress.note(note);
    if (!only_loops)
        if (auto done = done_before(tray, first, progress)) {
            for (int number = 0; is_same_job(folder_of_tray(asked.out, number), tray.job, &progress); ++number)
                hand_over(folder_of_tray(asked.out, number), printer_target(tray, number), asked.overwrite, progress);
            return *std::move(done);
        }
    expect_tray_replaceable(tray, 0, first, progress);
    std::vector<io::StackFolder> folders;
    folders.push_back(std::move(first));
    const ThreadLimit threads(static_cast<std::size_t>(tray.plan.common.threads));
    PreparedTray prepared = prepare_tray(tray, progress);
    for (int number = 1; number < prepared.trays(); ++number) {
        folders.push_back(take_tray_folder(folder_of_tray(tray.plan.common.out, number), progress));
        expect_tray_replaceable(tray, number, folders.back(), progress);
    }

    // From here on hours may be spent.
    rearrange_parts(tray, prepared, progress);
    if (only_loops) return loops_kept(tray, prepared);
    TrayReport report = report_for(prepared, tray.plan.common.out);
    std::vector<std::unique_ptr<TrayPrint>> prints;
    for (int number = 0; number < prepared.trays(); ++number) {
        prints.push_back(std::make_unique<TrayPrint>(tray, prepared, number, std::move(folders[std::size_t(number)])));
        prints.back()->make(report, progress);
    }
    set_aside_left_parts(tray, prepared, progress);
    JobResult result;
    for (const auto& print : prints) {
        JobResult made = print->finish(report, watch, progress);
        if (print == prints.front()) result.json = std::move(made.json);
        result.text += made.text;
    }
    result.exit_code = exit_code_of(tray, prepared.parts.failed, verdicts_of(prepared));
    result.failure = failure_of(prepared);
    return result;
}

}  // namespace voxtone::slicer
