// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/merge_job.h"

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/printer/printer_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/part/phase.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/part/prepared_body.h"
#include "slicer/part/report_files.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/output_folder.h"
#include "slicer/plate/prepared_job.h"
#include "slicer/plate/printer_page.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

JobMeasurements figures_of(const io::ShardSet& shards) {
    JobMeasurements sum;
    for (const io::ShardRecord& record : shards.records) {
        const io::ShardFigures& f = record.figures;
        sum.counts +=
            {f.body_voxels, f.shell_voxels, f.thin_voxels, f.solid_s, f.shell_s, f.colour_s, f.screen_s, f.runs_s};
        sum.encode_s += f.encode_s;
        sum.layers_s += f.layers_s;
        for (const auto& files : record.written.file_bytes) sum.layer_bytes += files.front();
    }
    return sum;
}

std::vector<io::ReportLayer> pictures_of(const io::ShardSet& shards) {
    std::vector<io::ReportLayer> pictures;
    for (const io::ShardRecord& record : shards.records)
        pictures.insert(pictures.end(), record.pictures.begin(), record.pictures.end());
    return pictures;
}

io::ReportSection shards_section(const io::ShardSet& shards) {
    io::ReportSection section;
    section.title = "Shards";
    section.paragraphs.emplace_back(
        "The layers were made in parts and laid together; times of the layers are those of all parts, added.");
    io::ReportTable table{"Parts of the layers", {"shard", "layers", "seconds", "host"}, {}};
    for (const io::ShardRecord& record : shards.records)
        table.rows.push_back({io::shard_text(record.number),
                              record.layers == 0
                                  ? std::string("none")
                                  : fmt::format("{} to {}", record.first_layer, record.first_layer + record.layers - 1),
                              fmt::format("{:.1f}", record.figures.total_s), record.host});
    section.tables.push_back(std::move(table));
    return section;
}

/// Of their job: another's may have the same layers, and be told of otherwise.
bool holds_merged(const fs::path& out, const io::ShardSet& shards) {
    return io::is_merged(out, shards) && recorded_identity(out) == shards.job();
}

/// Of a stack that may be there already: its own, or one that may be replaced.
void expect_replaceable(const MergeOptions& options, const io::StackFolder& folder, const io::ShardSet& shards) {
    if (options.overwrite || !folder.holds_stack()) return;
    if (recorded_identity(options.out) == shards.job()) return;
    io::expect_free_for_stack(options.out);
}

std::string job_text(const fs::path& out) {
    constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;
    const auto bytes = io::read_whole_file(io::shards_folder(out) / job_file_name, most_bytes);
    return {bytes.begin(), bytes.end()};
}

/// The job and its body, as far as the page of the printer's folder asks for them.
struct MergedPrint {
    OpenedJob job;
    std::optional<JobBody> body;
};

/// Nothing, with a warning, where the job cannot be opened any more: its layers are there all the same.
std::optional<MergedPrint> merged_print(const MergeOptions& options, const io::ShardSet& shards, const std::string& job,
                                        Progress& progress) {
    try {
        SliceOptions asked;
        (void)take_options(io::JsonObject::parse(job, job_file_name.data()), options.out, asked);
        asked.out = options.out.string();
        return MergedPrint{open_job(asked), read_prepared(options.out, shards.job())};
    } catch (const Error& error) {
        progress.warn(named_warning("printer-folder",
                                    fmt::format("{}: is not made, as the job cannot be opened: {}",
                                                (options.out / io::printer_folder_name).string(), error.what())));
        return std::nullopt;
    }
}

io::PageOfStack page_of(const MergedPrint& print) {
    const std::string title = fs::path(print.job.options.model).filename().string();
    std::vector<PlacedBody> bodies;
    if (print.body) bodies.push_back({title, *print.body, {{0, 0, 0}}});
    return printer_page(print.job, title, std::move(bodies));
}

/// Where it could not be made when the stack was merged.
void make_up_for_printer_folder(const MergeOptions& options, const io::ShardSet& shards, Progress& progress) {
    if (!io::waits_for_page(options.out, shards)) return;
    const io::StackFolder folder = take_output(options.out, {}, progress);
    if (const std::optional<MergedPrint> print = merged_print(options, shards, job_text(options.out), progress))
        io::add_printer_folder(folder, shards, page_of(*print), &progress);
}

void lay_together(const MergeOptions& options, const io::ShardSet& shards, Progress& progress) {
    if (holds_merged(options.out, shards)) return make_up_for_printer_folder(options, shards, progress);
    if (recorded_identity(io::shards_folder(options.out)) != shards.job())
        throw InputError(
            fmt::format("{}: is not of the job that the shards are of; make one of them again, with "
                        "--overwrite",
                        (io::shards_folder(options.out) / job_file_name).string()));
    io::StackFolder folder = take_output(options.out, {}, progress);
    expect_replaceable(options, folder, shards);
    say_strangers(folder, progress);
    io::expect_files(options.out, shards);
    const std::string job = job_text(options.out);
    const std::optional<MergedPrint> print = merged_print(options, shards, job, progress);
    io::PageOfStack page;
    if (print) page = page_of(*print);
    io::merge_shards(folder, shards, job, page, &progress);
}

/// The job that the shards are of, to draw its report.
OpenedJob open_merged(const MergeOptions& options) {
    SliceOptions requested;
    read_job((options.out / job_file_name).string(), requested);
    requested.out = options.out.string();
    requested.threads = options.threads;
    return open_job(requested, [&](const OpenedJob&, JobRun& run) {
        run.loop_elsewhere = true;
        if (!options.predict)
            run.why_unpredicted =
                "Its layers were made in shards: `voxtone merge --predict` predicts what they will look like.";
    });
}

/// A print that is predicted sees its layers; they are made again, and not written.
void show_layers(Print& print, const LayerRange& range, Progress& progress) {
    JobMeasurements unused;
    LayerWatchers nobody;
    make_layers(
        print, range, [](int, const io::LayerRuns&) {}, nobody, unused, progress);
}

JobResult write_merged_report(const MergeOptions& options, const io::ShardSet& shards, const Stopwatch& watch,
                              Progress& progress) {
    const OpenedJob opened = open_merged(options);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    std::optional<JobBody> kept;
    if (is_same_job(options.out, opened, &progress)) kept = read_prepared(options.out, shards.job());
    PreparedJob ready(opened, std::move(kept), progress);
    if (ready.identity.job != shards.job())
        throw InputError(fmt::format(
            "{}: the stack is merged and whole, but its report cannot be drawn: the model, or another file that the "
            "job names, has changed since the shards were made; --no-report does without",
            options.out.string()));
    const OpenedJob& job = ready.job;
    const VoxelGrid& grid = ready.plan.grid;
    const LayerRange& range = ready.plan.layers;
    Print& print = *ready.print;
    print.prepare(progress);
    expect_stages(progress, options.predict
                                ? expected_stages(ready.plan.phases, {Phase::layers, Phase::predict, Phase::report})
                                : expected_stages(ready.plan.phases, {Phase::report}));
    std::optional<VoxelSample> voxels;
    if (job.options.report) {
        voxels.emplace(range.first, range.layers(), grid);
        for (const io::ShardRecord& record : shards.records) voxels->put(record.viewer);
    }
    if (options.predict)
        show_layers(print, range, progress);
    else
        print.expect_layers(range);
    print.evaluate(shards.stack, progress);
    progress.begin_stage(name_of(Phase::report), 0);
    JobMeasurements figures = figures_of(shards);
    figures.read_s = ready.figures.read_s;
    figures.repair_s = ready.figures.repair_s;
    io::Report report = make_report(job, ready.body, shards.stack, print, figures);
    report.layers = pictures_of(shards);
    report.sections.push_back(shards_section(shards));
    for (const io::ShardRecord& record : shards.records)
        report.peak_memory_bytes = std::max(report.peak_memory_bytes, record.figures.peak_memory_bytes);
    JobResult told = write_report(job, print, report, voxels, watch, progress);
    progress.end_stage();
    std::error_code not_there;
    fs::remove(io::prepared_file(options.out, shards.job()), not_there);
    return told;
}

JobResult short_result(const fs::path& out, const io::ShardSet& shards, const char* what) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-merge").add("version", 1).add("stack", out.string());
    json.add("shards", shards.records.size()).add("layers", shards.stack.layers);
    json.add("content_sha256", shards.stack.content_sha256).end_object();
    return {
        json.text(),
        fmt::format("{}: {} layers of {} shards; {}\n", out.string(), shards.stack.layers, shards.records.size(), what),
        ExitCode::done};
}

}  // namespace

MergedTelling telling_of_body(const MergeOptions& options, Progress& progress) {
    return {[&](const io::ShardSet&) { return fs::exists(options.out / report_file::figures); },
            [&, watch = Stopwatch()](const io::ShardSet& shards) {
                return write_merged_report(options, shards, watch, progress);
            }};
}

JobResult run_merge_job(const MergeOptions& options, const MergedTelling& telling, Progress& progress) {
    if (std::error_code none; !fs::is_directory(options.out, none))
        throw FileError(fmt::format("{}: is no folder; name the output folder of the shards", options.out.string()));
    const io::ShardSet shards = io::read_shards(options.out, {std::uint32_t(options.shards)}, &progress);
    io::sweep_shards(options.out);
    const bool was_merged = holds_merged(options.out, shards);
    if (!options.for_printer.empty()) io::expect_printer_target(options.out, options.for_printer, options.overwrite);
    lay_together(options, shards, progress);
    hand_over(options.out, options.for_printer, options.overwrite, progress);
    if (std::error_code not_there; !options.report && !io::waits_for_page(options.out, shards))
        fs::remove(io::prepared_file(options.out, shards.job()), not_there);
    if (!options.report) return short_result(options.out, shards, was_merged ? "merged already" : "merged");
    if (was_merged && !options.predict && telling.is_told(shards))
        return short_result(options.out, shards, "merged already, with its report; nothing was done");
    return telling.tell_of(shards);
}

}  // namespace voxtone::slicer
