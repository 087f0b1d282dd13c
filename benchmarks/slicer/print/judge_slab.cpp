// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge_slab.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "flat_white.h"
#include "optics/colour/observed_colour.h"
#include "slicer/options/resolve_job.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/surface/target_cells.h"
#include "traced.h"

namespace voxtone::loop_benchmark {

Colours Judgement::print() const {
    Colours mean(half[0].size());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5F * (half[0][i] + half[1][i]);
    return mean;
}

void map_target(const slicer::SliceOptions& options, std::optional<double> picture_thickness_mm, Judgement& j) {
    slicer::ResolvedJob flat = slicer::resolve(options);
    flat.colour.depth_mm = 1;
    std::optional<slicer::SlabUnderColour> slab;
    if (picture_thickness_mm) slab = {*picture_thickness_mm, flat.picture.backing};
    const slicer::PrinterProfile printer = slicer::find_printer(flat.printer);
    const slicer::LoadedResins resins = slicer::load_resins(flat, printer);
    Progress progress;
    const auto colour = slicer::prepare_colour(flat.colour, resins, printer.sliced_pitch_mm(), slab, progress);
    j.in_gamut.resize(j.target.size());
    j.mapped.resize(j.target.size());
    parallel_for(0, j.target.size(), 256, [&](std::size_t i) {
        j.in_gamut[i] = colour->separation.gamut_distance(j.target[i]) < 1;
        j.mapped[i] = j.in_gamut[i] ? j.target[i] : colour->separation.predicted(j.target[i]).cast<float>().eval();
    });
}

namespace {

std::vector<float> white_shares(const slicer::StackVolume& stack, const Judgement& j, const std::array<int, 3>& cell) {
    const auto& size = stack.volume.size();
    const int layers = std::min(size[2], static_cast<int>(std::lround(white_depth_mm / stack.volume.pitch_mm()[2])));
    std::vector<float> share(j.surface.cells.size());
    parallel_for(0, share.size(), 256, [&](std::size_t i) {
        const int x0 = static_cast<int>(i % j.columns) * cell[0], y0 = static_cast<int>(i / j.columns) * cell[1];
        int white = 0, all = 0;
        for (int z = size[2] - layers; z < size[2]; ++z)
            for (int y = y0; y < std::min(size[1], y0 + cell[1]); ++y)
                for (int x = x0; x < std::min(size[0], x0 + cell[0]); ++x, ++all)
                    white += stack.volume.at(x, y, z) == stack.white + 1;
        share[i] = static_cast<float>(white) / static_cast<float>(std::max(1, all));
    });
    return share;
}

}  // namespace

Judgement judge_slab(const slicer::SliceOptions& options, const Effort& effort) {
    Progress progress;
    const slicer::StackVolume stack = slicer::read_stack_volume({.stack = options.out}, progress);
    VOXTONE_EXPECT(stack.of_picture && stack.white >= 0);
    const optics::Scene scene{.volume = &stack.volume,
                              .resins = &stack.resins,
                              .backing = stack.backing.value_or(optics::Backing::black).kind,
                              .sides = optics::Sides::open};
    const auto cell = optics::cell_voxels(stack.volume.pitch_mm(), effort.cell_mm);
    Judgement j;
    j.surface = optics::find_surface(scene, cell, optics::SurfacePart::top);
    const auto& size = stack.volume.size();
    j.columns = static_cast<std::size_t>((size[0] + cell[0] - 1) / cell[0]);
    j.rows = static_cast<std::size_t>((size[1] + cell[1] - 1) / cell[1]);
    VOXTONE_EXPECT(j.surface.cells.size() == j.columns * j.rows);  // a box, in order of y, x
    j.white_share = white_shares(stack, j, cell);

    const slicer::JobBody body =
        slicer::prepare_body(slicer::resolve(options), slicer::find_printer(options.printer), progress);
    j.target = slicer::target_of_cells(j.surface, stack.volume.pitch_mm(), body.grid.origin_mm, body.surface,
                                       body.model.mesh, nullptr);
    map_target(options, body.placement.extent_mm.z(), j);

    const auto start = std::chrono::steady_clock::now();
    const std::string digest = volume_digest(stack.volume);
    std::array<std::vector<float>, 2> value;
    for (std::size_t h = 0; h < 2; ++h) {
        Tracing how;
        how.paths = effort.paths;
        how.seed = h + 1;
        value[h] = traced(scene, digest, j.surface, how, effort.cache);
    }
    const optics::ResinVolume twin = optics::all_of(stack.volume, static_cast<optics::Material>(stack.white + 1));
    optics::Scene white_scene = scene;
    white_scene.volume = &twin;
    Tracing how;
    how.paths = effort.white_paths;
    how.seed = 3;
    std::vector<float> white = traced(white_scene, volume_digest(twin), j.surface, how, effort.cache);
    const std::size_t channels = stack.resins.channels.size();
    smooth_flat_white(white, j.columns, j.rows, channels, effort.cell_mm, size[0] % cell[0] == 0,
                      size[1] % cell[1] == 0);
    j.trace_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    const optics::ObservedColour<float> observed(stack.resins.channels);
    for (std::size_t h = 0; h < 2; ++h) {
        j.half[h].resize(j.surface.cells.size());
        for (std::size_t i = 0; i < j.half[h].size(); ++i)
            j.half[h][i] = observed.relative(value[h].data() + i * channels, white.data() + i * channels);
    }
    return j;
}

}  // namespace voxtone::loop_benchmark
