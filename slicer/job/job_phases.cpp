// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/job/job_phases.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "io/disk/disk_space.h"
#include "io/files/whole_file.h"
#include "io/report/report_html.h"
#include "io/report/report_json.h"
#include "io/shards/shard_folder.h"
#include "slicer/colour/colour_print.h"
#include "slicer/estimate/phase_estimates.h"
#include "slicer/kept/report_files.h"
#include "slicer/kept/skin_file.h"
#include "slicer/layered/layered_print.h"
#include "slicer/layers/layer_maker.h"
#include "slicer/look/viewer_surface.h"
#include "slicer/options/job_file.h"
#include "slicer/prepare/resin_choice.h"

namespace voxtone::slicer {

JobBody read_body(const OpenedJob& job, JobMeasurements& figures, Progress& progress) {
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

void expect_no_other_shards(const OpenedJob& job, const Progress* progress) {
    const std::filesystem::path folder = io::shards_folder(job.options.out);
    if (std::error_code none; !std::filesystem::exists(folder / job_file_name, none)) return;
    if (is_same_job(folder, job, progress)) return;
    throw InputError(
        fmt::format("{}: holds shards of another job, which would be lost: name another folder, merge them first, or "
                    "allow it with --overwrite",
                    folder.string()));
}

void expect_own_loop(const OpenedJob& job, const Progress* progress) {
    const ResolvedJob& options = job.options;
    const bool is_replaced = options.overwrite && !options.loop.elsewhere && !options.loop.mixtures_named;
    if (options.layered || options.loop.iterations == 0 || is_replaced) return;
    if (options.until == Until::loop && options.overwrite) return;
    if (std::error_code none; !std::filesystem::exists(options.loop.mixtures, none)) return;
    SkinFile::expect_same_job(options.loop.mixtures, opened_loop_identity(job, progress), options.asked.iterations);
}

void expect_disk_space(const OpenedJob& job, const JobBody& body, const LayerRange& range, Progress& progress) {
    const ResolvedJob& options = job.options;
    const std::uint64_t needed = disk_bytes(job, body, range);
    if (const std::optional<std::uint64_t> free = io::free_disk_bytes(options.out))
        progress.note(fmt::format("the stack takes up to {} of the {} that the disk of {} has free",
                                  io::bytes_text(needed), io::bytes_text(*free), options.out.string()));
    io::expect_disk_space(options.out, needed, "the stack and its report");
}

std::unique_ptr<Print> make_print(const OpenedJob& job, const JobBody& body, const JobIdentity& identity,
                                  Progress& progress) {
    if (job.options.layered) return std::make_unique<LayeredPrint>(job, body, progress);
    return std::make_unique<ColourPrint>(job, body, identity, progress);
}

void LayerWatchers::see(int k, const io::LayerRuns& layer) {
    if (thumbnails) thumbnails->offer(k, layer);
    if (voxels) voxels->offer(k, layer);
}

void make_layers(Print& print, const LayerRange& range, const LayerTaker& take, LayerWatchers& watchers,
                 JobMeasurements& figures, Progress& progress) {
    const Stopwatch watch;
    print.expect_layers(range);
    const LayerMaker maker(print.sources());
    std::mutex figures_mutex;
    progress.begin_stage("layers", std::uint64_t(range.layers()), "layers");
    const auto write = [&](int k, const io::LayerRuns& layer, double& encode_s) {
        progress.check_cancelled();
        const Stopwatch encode;
        take(k, layer);
        encode_s += encode.total();
        watchers.see(k, layer);
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

/// Pictures of layers are for browsers that cannot show the voxels: fewer of them leave room for these.
static void keep_some(std::vector<io::ReportLayer>& layers) {
    constexpr std::size_t enough = 12;
    const std::size_t step = std::max<std::size_t>(1, layers.size() / enough);
    std::vector<io::ReportLayer> kept;
    for (std::size_t i = 0; i < layers.size(); i += step) kept.push_back(std::move(layers[i]));
    layers = std::move(kept);
}

std::string write_report(const OpenedJob& job, const Print& print, io::Report& report,
                         std::optional<VoxelSample>& voxels, const Stopwatch& since_begin, Progress& progress) {
    const std::filesystem::path& folder = job.options.out;
    if (job.options.report) {
        const Stopwatch watch;
        if (voxels) keep_some(report.layers);
        print.draw(report, progress);
        if (voxels) {
            report.viewer.voxels = voxels->take(voxel_bytes_left(report));
            report.viewer.voxels->layer_file = io::StackDescription{}.pattern;
        }
        report.stages.push_back({"draw the report", watch.total()});
    }
    report.total_seconds = since_begin.total();
    if (job.options.report) io::write_whole_file(folder / report_file::page, io::report_html(report));
    std::string json = io::report_json(report);
    io::write_whole_file(folder / report_file::figures, json);
    return json;
}

}  // namespace voxtone::slicer
