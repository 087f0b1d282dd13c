// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/job_phases.h"

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>

#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/report/customer_page.h"
#include "io/report/report_json.h"
#include "slicer/look/viewer_surface.h"
#include "slicer/part/phase.h"
#include "slicer/part/report_files.h"
#include "slicer/plate/memory_room.h"

namespace voxtone::slicer {

namespace {

/// `look_on`: after a layer is taken.
void make_slabs(const LayerSource& layers, const LayerRange& range, const LayerTaker& take, const LayerTaker& look_on,
                JobMeasurements& figures, Progress& progress) {
    constexpr std::uint64_t bytes_at_once = 1'000'000'000;  // of slabs that are made side by side
    const Stopwatch watch;
    MemoryRoom room(bytes_at_once);
    std::mutex figures_mutex;
    const int depth = layers.slab_layers();
    progress.begin_stage(name_of(Phase::layers), std::uint64_t(range.layers()), "layers");
    const auto write = [&](int k, const io::LayerRuns& layer, double& encode_s) {
        progress.check_cancelled();
        const Stopwatch encode;
        take(k, layer);
        encode_s += encode.total();
        look_on(k, layer);
        progress.advance();
    };
    const auto make = [&](std::size_t slab) {
        double encode_s = 0;
        const LayerCounts counts = layers.make(int(slab), range.first, range.last + 1,
                                               [&](int k, const io::LayerRuns& layer) { write(k, layer, encode_s); });
        const std::scoped_lock lock(figures_mutex);
        figures.counts += counts;
        figures.encode_s += encode_s;
    };
    parallel_for(
        std::size_t(range.first / depth), std::size_t(range.last / depth) + 1, 1,
        [&](std::size_t slab) { room.with([&] { return layers.slab_bytes(); }, [&] { make(slab); }); }, &progress);
    progress.end_stage();
    figures.layers_s = watch.total();
}

}  // namespace

BodyPreview::BodyPreview(const JobBody& body, bool wanted) {
    if (!wanted) return;
    const SolidMesh& solid = *body.solid;
    positions_mm_.reserve(solid.positions_mm.size());
    for (const Eigen::Vector3d& p : solid.positions_mm)
        positions_mm_.push_back({float(p.x()), float(p.y()), float(p.z())});
    if (!positions_mm_.empty()) triangles_ = solid.triangles;
}

io::PreviewMesh BodyPreview::mesh() const { return {positions_mm_, triangles_}; }

void LayerWatchers::watch(const LayerRange& layers, const VoxelGrid& grid, const OpenedJob& job) {
    thumbnails.emplace(layers.first, layers.layers(), grid, job.palette());
    voxels.emplace(layers.first, layers.layers(), grid);
}

void LayerWatchers::take_layer(int k, const io::LayerRuns& layer) {
    if (thumbnails) thumbnails->offer(k, layer);
    if (voxels) voxels->offer(k, layer);
}

void make_layers(const LayerSource& layers, const LayerRange& range, const LayerTaker& take, LayerWatchers& watchers,
                 JobMeasurements& figures, Progress& progress) {
    make_slabs(
        layers, range, take, [&](int k, const io::LayerRuns& layer) { watchers.take_layer(k, layer); }, figures,
        progress);
}

void make_layers(Print& print, const LayerRange& range, const LayerTaker& take, LayerWatchers& watchers,
                 JobMeasurements& figures, Progress& progress) {
    print.expect_layers(range);
    const auto look_on = [&](int k, const io::LayerRuns& layer) {
        watchers.take_layer(k, layer);
        print.take_layer(k, layer);
    };
    make_slabs(*print.layers(), range, take, look_on, figures, progress);
}

void draw_report(const Print& print, io::Report& report, std::optional<VoxelSample>& voxels, std::string layer_file,
                 Progress& progress) {
    const Stopwatch watch;
    print.draw(report, progress);
    if (voxels) {
        report.viewer.voxels = voxels->take(voxel_bytes_left(report));
        report.viewer.voxels->layer_file = std::move(layer_file);
    }
    report.stages.push_back({"draw the report", watch.total()});
}

JobResult write_report(const OpenedJob& job, const Print& print, io::Report& report, std::optional<VoxelSample>& voxels,
                       const Stopwatch& since_begin, Progress& progress) {
    const std::filesystem::path& folder = job.options.out;
    if (job.options.report) draw_report(print, report, voxels, io::StackDescription{}.pattern, progress);
    report.total_seconds = since_begin.total();
    if (job.options.report) {
        write_page(folder, report);
        io::write_whole_file(folder / report_file::customer_page, io::customer_html(report));
    }
    std::string json = io::report_json(report);
    io::write_whole_file(folder / report_file::figures, json);
    const bool bad = report.verdict && report.verdict->level == io::VerdictLevel::bad;
    return {std::move(json), summary_text(print, report, since_begin.total(), job.options.report, folder),
            bad && job.options.strict ? ExitCode::check_failed : ExitCode::done,
            bad ? std::optional(report.verdict->sentence) : std::nullopt};
}

}  // namespace voxtone::slicer
