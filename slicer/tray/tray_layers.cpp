// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_layers.h"

#include <mutex>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "slicer/prepare/phase.h"
#include "slicer/tray/component_surface.h"

namespace voxtone::slicer {

namespace {

/// Voxels of each resin in layers that are not written.
class ResinCounter {
public:
    explicit ResinCounter(std::size_t resins) : voxels_(resins + 1) {}
    /// From any thread.
    void add(const io::LayerRuns& layer) {
        std::vector<std::uint64_t> mine(voxels_.size());
        for (std::uint32_t y = 0; y < layer.height_px(); ++y)
            for (const io::Run& run : layer.row(y)) mine[run.material] += run.length;
        const std::scoped_lock lock(mutex_);
        for (std::size_t m = 0; m < mine.size(); ++m) voxels_[m] += mine[m];
    }
    void fill_in(io::StackDescription& stack) const {
        for (std::size_t r = 0; r < stack.resins.size(); ++r) {
            stack.resins[r].voxels = voxels_[r + 1];
            stack.resins[r].ml = io::millilitres(voxels_[r + 1], stack.pitch_um);
        }
    }

private:
    std::mutex mutex_;
    std::vector<std::uint64_t> voxels_;
};

void report_part(ReadyPart& part, TrayReport& tray, Progress& progress) {
    const Stopwatch watch;
    PreparedJob& ready = *part.ready;
    LayerWatchers watchers;
    const LayerRange& range = ready.plan.layers;
    io::StackDescription stack = ready.job.describe(ready.plan.grid, range);
    watchers.thumbnails.emplace(range.first, range.layers(), ready.plan.grid, ready.job.palette());
    watchers.voxels.emplace(range.first, range.layers(), ready.plan.grid);
    ResinCounter resins(stack.resins.size());
    make_layers(
        *ready.print, range, [&](int, const io::LayerRuns& layer) { resins.add(layer); }, watchers, ready.figures,
        progress);
    resins.fill_in(stack);
    ready.print->look(stack, progress);
    progress.begin_stage(name_of(Phase::report), 0);
    io::Report report = make_report(ready.job, ready.body, stack, *ready.print, ready.figures);
    report.layers = watchers.thumbnails->take();
    part.report = write_report(ready.job, *ready.print, report, watchers.voxels, watch, progress);
    tray.add(part, report, progress);
    ready.print->forget_looks();
    progress.end_stage();
}

}  // namespace

void watch_all(LayerWatchers& watchers, const VoxelGrid& grid, const OpenedJob& job) {
    watchers.thumbnails.emplace(0, grid.size[2], grid, job.palette());
    watchers.voxels.emplace(0, grid.size[2], grid);
}

void make_tray_layers(const ComposedLayers& layers, const LayerRange& range, const LayerTaker& take,
                      LayerWatchers& watchers, Progress& progress) {
    const int depth = layers.slab_layers();
    progress.begin_stage(name_of(Phase::layers), std::uint64_t(range.layers()), "layers");
    parallel_for(
        std::size_t(range.first / depth), std::size_t(range.last / depth) + 1, 1,
        [&](std::size_t slab) {
            (void)layers.make(int(slab), range.first, range.last + 1, [&](int k, const io::LayerRuns& layer) {
                progress.check_cancelled();
                take(k, layer);
                watchers.see(k, layer);
                progress.advance();
            });
        },
        &progress);
    progress.end_stage();
}

TrayReport report_for(const PreparedTray& prepared, const std::filesystem::path& out) {
    std::size_t copies = 0;
    for (const ReadyPart& part : prepared.parts.ready) copies += part.alone.size();
    return {copies, folder_of_tray(out, 0).filename().string()};
}

void report_parts(PreparedTray& prepared, TrayReport& tray, Progress& progress) {
    for (ReadyPart& part : prepared.parts.ready) {
        if (part.alone.empty()) continue;
        if (part.component)
            tray.add_component(part, part.part.cuts ? std::nullopt
                                                    : component_surface(*part.component, prepared.any_job(),
                                                                        tray.surface_share(), progress));
        else
            report_part(part, tray, progress);
    }
}

}  // namespace voxtone::slicer
