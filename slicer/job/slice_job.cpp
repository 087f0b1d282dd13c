// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/slice_job.h"

#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/stop_deadline.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/io/disk/disk_space.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/layers/layer_stack_writer.h"
#include "voxtone/io/layers/stack_folder.h"
#include "voxtone/io/report/report_json.h"
#include "voxtone/slicer/job/colour_print.h"
#include "voxtone/slicer/job/job_body.h"
#include "voxtone/slicer/job/job_identity.h"
#include "voxtone/slicer/job/job_stages.h"
#include "voxtone/slicer/job/layered_print.h"
#include "voxtone/slicer/job/loop_checkpoint.h"
#include "voxtone/slicer/job/opened_job.h"
#include "voxtone/slicer/job/resin_choice.h"
#include "voxtone/slicer/job/slice_report.h"
#include "voxtone/slicer/layers/layer_bytes.h"
#include "voxtone/slicer/layers/layer_maker.h"
#include "voxtone/slicer/look/report_files.h"
#include "voxtone/slicer/look/thumbnails.h"
#include "voxtone/slicer/options/job_file.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

JobBody read_body(const OpenedJob& job, JobFigures& figures, Progress& progress) {
    const Stopwatch watch;
    JobBody body = prepare_body(job.options, job.printer, progress);
    for (const std::string& warning : body.warnings) progress.warn(warning);
    progress.note(body.placement.summary);
    for (const std::string& note : body.notes) progress.note(note);
    figures.read_s = body.read_s;
    figures.repair_s = watch.total() - body.read_s;
    return body;
}

void load_best_resins(OpenedJob& job, const JobBody& body, Progress& progress) {
    const auto choice = choose_resins(job, body, progress);
    if (!choice) return;
    job.load(choice->roles);
    job.why_these_resins = choice->why;
    progress.note(choice->why);
}

JobIdentity identify_said(const OpenedJob& job, const JobBody& body, Progress& progress) {
    JobIdentity identity = identify(job, body.side_files, &progress);
    for (const std::string& changed : changed_inputs(job.options.asked.recorded_inputs, identity.inputs))
        progress.warn(changed);
    return identity;
}

std::unique_ptr<Print> make_print(const OpenedJob& job, const JobBody& body, const JobIdentity& identity,
                                  Progress& progress) {
    if (job.options.layered) return std::make_unique<LayeredPrint>(job, body, progress);
    return std::make_unique<ColourPrint>(job, body, identity, progress);
}

/// Whether the folder holds this very job's stack, whole, though perhaps without its report.
bool holds_this_stack(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    return folder.holds_stack() && is_same_job(folder.path(), job, &progress);
}

bool has_checkpoint(const io::StackFolder& folder) { return fs::exists(folder.path() / io::checkpoint_name); }

/// What was said when this very job was done, where nothing is left of it to do.
std::optional<SliceResult> done_before(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    const fs::path figures = folder.path() / report_file::figures;
    if (job.options.overwrite || has_checkpoint(folder) || !fs::exists(figures) ||
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
}

/// A saved loop of another job is refused before the model is read.
void expect_resumable(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
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

/// Says how much will be needed and is free. Throws TryAgain where that is too little.
void expect_disk_space(const OpenedJob& job, const JobBody& body, const LayerRange& range, Progress& progress) {
    constexpr std::uint64_t report_bytes = 4'000'000;
    const ResolvedJob& options = job.options;
    const double shell_mm = options.layered ? options.layered->thickness_mm : options.colour.depth_mm;
    const std::uint64_t needed = layer_bytes(body.grid, {coloured_area_mm2(*body.surface), shell_mm, range.layers(),
                                                         job.outputs(), job.resins.entries.size()}) +
                                 (options.report ? report_bytes : 0);
    if (const std::optional<std::uint64_t> free = io::free_disk_bytes(options.out))
        progress.note(fmt::format("the stack takes up to {} of the {} that the disk of {} has free",
                                  io::bytes_text(needed), io::bytes_text(*free), options.out.string()));
    io::expect_disk_space(options.out, needed, "the stack and its report");
}

/// Makes the layers, in slabs side by side; each goes to the writer and to those who look on.
void write_layers(Print& print, const LayerRange& range, io::LayerStackWriter& writer,
                  std::optional<Thumbnails>& thumbnails, JobFigures& figures, Progress& progress) {
    const Stopwatch watch;
    print.expect_layers(range);
    const LayerMaker maker(print.sources());
    std::mutex figures_mutex;
    progress.begin_stage("layers", std::uint64_t(range.layers()), "layers");
    const auto write = [&](int k, const io::LayerRuns& layer, double& encode_s) {
        progress.check_cancelled();
        const Stopwatch encode;
        writer.write(std::uint32_t(k - range.first), layer);
        encode_s += encode.total();
        if (thumbnails) thumbnails->offer(k, layer);
        print.see(k, layer);
        progress.advance();
    };
    parallel_for(
        std::size_t(range.first / maker.slab_layers()), std::size_t(range.last / maker.slab_layers()) + 1, 1,
        [&](std::size_t slab) {
            double encode_s = 0;
            const LayerCounts counts =
                maker.make(int(slab), range.first, range.last + 1,
                           [&](int k, const io::LayerRuns& layer) { write(k, layer, encode_s); });
            const std::scoped_lock lock(figures_mutex);
            figures.counts += counts;
            figures.encode_s += encode_s;
        },
        &progress);
    progress.end_stage();
    figures.layers_s = watch.total();
}

/// The printed body for a container's preview.
std::vector<std::array<float, 3>> single_precision(const std::vector<Eigen::Vector3d>& positions) {
    std::vector<std::array<float, 3>> out;
    out.reserve(positions.size());
    for (const Eigen::Vector3d& p : positions) out.push_back({float(p.x()), float(p.y()), float(p.z())});
    return out;
}

const io::StackDescription& finish_stack(const OpenedJob& job, const JobBody& body, const JobIdentity& identity,
                                         io::LayerStackWriter& writer, JobFigures& figures, Progress& progress) {
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

/// Draws and writes the report; its JSON.
std::string write_report(const OpenedJob& job, const Print& print, io::Report& report, const Stopwatch& since_begin,
                         Progress& progress) {
    const fs::path& folder = job.options.out;
    if (job.options.report) {
        const Stopwatch watch;
        print.draw(report, progress);
        report.stages.push_back({"draw the report", watch.total()});
    }
    report.total_seconds = since_begin.total();
    if (job.options.report) io::write_whole_file(folder / report_file::page, io::report_html(report));
    std::string json = io::report_json(report);
    io::write_whole_file(folder / report_file::figures, json);
    return json;
}

}  // namespace

SliceResult run_slice_job(const SliceOptions& asked, Progress& progress) {
    const Stopwatch watch;
    JobFigures figures;
    // All that can refuse the job, from what costs nothing to what costs most ...
    OpenedJob job = open_job(asked);
    // From here on the output folder is this job's; what it holds stays until the new stack is whole.
    io::StackFolder folder(job.options.out, {report_file::all.begin(), report_file::all.end()});
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
    expect_stages(progress, expected_stages(job, body, range));
    const std::unique_ptr<Print> print = make_print(job, body, identity, progress);
    print->prepare(progress);

    // ... and from here on hours may be spent.
    io::LayerStackWriter writer(std::move(folder), job.describe(body.grid, range), job.outputs());
    print->rearrange(progress);
    std::optional<Thumbnails> thumbnails;
    if (job.options.report) thumbnails.emplace(range.first, range.layers(), body.grid, job.palette());
    write_layers(*print, range, writer, thumbnails, figures, progress);
    const io::StackDescription& stack = finish_stack(job, body, identity, writer, figures, progress);
    LoopCheckpoint::remove_from(job.options.out);
    set_stop_advice({});

    print->look(stack, progress);
    progress.begin_stage("report", 0);
    io::Report report = make_report(job, body, stack, *print, figures);
    if (thumbnails) report.layers = thumbnails->take();
    std::string json = write_report(job, *print, report, watch, progress);
    progress.end_stage();
    const bool bad = report.verdict && report.verdict->level == io::VerdictLevel::bad;
    return {std::move(json), summary_text(*print, report, watch.total(), job.options.report, writer.folder()),
            bad && job.options.strict ? ExitCode::check_failed : ExitCode::done};
}

}  // namespace voxtone::slicer
