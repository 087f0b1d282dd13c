// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/slice_job.h"

#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <vector>

#include "voxtone/base/parallel.h"
#include "voxtone/base/stop_deadline.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/layers/layer_stack_writer.h"
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

/// Reports of an earlier job in this folder do not describe this one.
void remove_old_report(const fs::path& folder) {
    for (const std::string_view name : report_file::all) {
        std::error_code not_there;
        fs::remove(folder / name, not_there);
    }
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
    const io::StackDescription& stack = writer.finish(preview, &progress);
    io::write_whole_file(writer.folder() / job_file_name,
                         job_record(job.options.asked, identity.inputs, job.options.out));
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
    const ThreadLimit threads(static_cast<std::size_t>(job.options.threads));
    for (const std::string& warning : job.printer.warnings()) progress.warn(warning);
    const JobBody body = read_body(job, figures, progress);
    const JobIdentity identity = identify_said(job, body, progress);
    load_best_resins(job, body, progress);
    const LayerRange range = range_within(job.options.layers, body.grid.size[2]);
    expect_stages(progress, expected_stages(job, body, range));
    const std::unique_ptr<Print> print = make_print(job, body, identity, progress);
    print->prepare(progress);

    // ... and from here on the output folder is this job's.
    io::LayerStackWriter writer(job.options.out, job.describe(body.grid, range), job.outputs(), job.options.overwrite);
    remove_old_report(writer.folder());
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
