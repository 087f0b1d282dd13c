// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge_body.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/random.h"
#include "halftone/loop/colour_regions.h"
#include "optics/colour/observed_colour.h"
#include "optics/scene/surface_smoothing.h"
#include "slicer/mesh/mesh_boundary.h"
#include "slicer/options/resolve_job.h"
#include "slicer/part/job_body.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/surface/target_cells.h"
#include "traced.h"

namespace voxtone::loop_benchmark {
namespace {

constexpr double thin_mm = 2, least_thin_mm2 = 5, white_spread_mm = 0.3;

Eigen::Vector3f vector_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

/// Less than thin_mm from the cell through the body, against the normal, to the air behind.
bool is_thin(const optics::ResinVolume& volume, const optics::SurfaceCell& cell) {
    const auto& pitch = volume.pitch_mm();
    for (double depth = 0.1; depth < thin_mm; depth += 0.02) {
        std::array<int, 3> voxel{};
        for (std::size_t a = 0; a < 3; ++a)
            voxel[a] = static_cast<int>(std::floor(
                (static_cast<double>(cell.centre_mm[a]) - depth * static_cast<double>(cell.normal[a])) / pitch[a]));
        if (volume.at(voxel[0], voxel[1], voxel[2]) == optics::air) return true;
    }
    return false;
}

/// Cells drawn by area: every second one of the thin parts, the others of the rest; all of one where there is no other.
std::vector<std::size_t> draw_centres(const optics::Surface& surface, const std::vector<char>& thin,
                                      const WindowChoice& choice) {
    std::array<std::vector<double>, 2> area;
    std::array<std::vector<std::size_t>, 2> cell;
    std::array<double, 2> sum{};
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const std::size_t part = thin[i] ? 1 : 0;
        area[part].push_back(sum[part] += static_cast<double>(surface.cells[i].area_mm2));
        cell[part].push_back(i);
    }
    std::vector<std::size_t> centres;
    for (std::size_t w = 0; w < choice.windows; ++w) {
        RandomStream random(choice.seed, w);
        const std::size_t part = sum[1] < least_thin_mm2 ? 0 : sum[0] < least_thin_mm2 ? 1 : w % 2;
        const auto at = std::upper_bound(area[part].begin(), area[part].end(), random.uniform() * sum[part]);
        centres.push_back(
            cell[part][std::min(cell[part].size() - 1, static_cast<std::size_t>(at - area[part].begin()))]);
    }
    return centres;
}

/// In the largest solids of flat colour, in their interiors where they have some.
std::vector<std::size_t> draw_in_solids(const optics::Surface& whole, const Colours& target, const WindowChoice& choice,
                                        BodyJudgement& j) {
    std::vector<std::size_t> centres;
    for (const halftone::ColourRegion& region : halftone::colour_regions(whole, target)) {
        if (region.kind != halftone::RegionKind::solid) continue;
        if (j.solids.size() == choice.solids) break;
        j.solids.push_back({region.target, region.area_mm2});
        for (std::size_t w = 0; w < std::max<std::size_t>(1, choice.windows / choice.solids); ++w) {
            RandomStream random(choice.seed, centres.size());
            const auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(region.interior.size()));
            centres.push_back(region.interior[std::min(at, region.interior.size() - 1)]);
            j.solid_of.push_back(static_cast<std::uint32_t>(j.solids.size() - 1));
        }
    }
    return centres;
}

/// The part of the surface that the windows see, with cells and faces of its own.
optics::Surface take_windows(const optics::Surface& whole, const std::vector<char>& thin,
                             const std::vector<std::size_t>& centres, const WindowChoice& choice, BodyJudgement& j) {
    std::vector<std::uint32_t> chosen;
    j.windows = centres.size();
    for (std::size_t w = 0; w < centres.size(); ++w) {
        const Eigen::Vector3f centre = vector_of(whole.cells[centres[w]].centre_mm),
                              normal = vector_of(whole.cells[centres[w]].normal);
        for (std::size_t i = 0; i < whole.cells.size(); ++i) {
            const optics::SurfaceCell& cell = whole.cells[i];
            const auto away = static_cast<double>((vector_of(cell.centre_mm) - centre).norm());
            if (away > choice.radius_mm || vector_of(cell.normal).dot(normal) < 0.342F) continue;
            chosen.push_back(static_cast<std::uint32_t>(i));
            j.window.push_back(static_cast<std::uint32_t>(w));
            j.thin.push_back(thin[i]);
            j.inner.push_back(away <= choice.radius_mm / 2);
        }
    }
    return optics::part_of(whole, chosen);
}

void smooth_white(const optics::Surface& surface, std::vector<float>& white, std::size_t channels, double cell_mm) {
    std::vector<optics::SurfacePoint> points;
    for (const optics::SurfaceCell& c : surface.cells)
        points.push_back({c.centre_mm, c.normal, std::max(c.area_mm2, 1e-9F)});
    const optics::SurfaceSmoothing smoothing(points, white_spread_mm, 0, cell_mm);
    std::vector<float> one(points.size()), smooth(points.size());
    for (std::size_t c = 0; c < channels; ++c) {  // sets have as many as they like
        for (std::size_t i = 0; i < one.size(); ++i) one[i] = white[i * channels + c];
        smoothing.apply(one, smooth, 1);
        for (std::size_t i = 0; i < one.size(); ++i) white[i * channels + c] = smooth[i];
    }
}

}  // namespace

BodyJudgement judge_body(const slicer::SliceOptions& options, const Effort& effort, const WindowChoice& choice) {
    Progress progress;
    const slicer::StackVolume stack = slicer::read_stack_volume({.stack = options.out}, progress);
    VOXTONE_EXPECT(!stack.of_picture && stack.white >= 0);
    const slicer::JobBody body =
        slicer::prepare_body(slicer::resolve(options), slicer::find_printer(options.printer), progress);
    const optics::Scene scene{.volume = &stack.volume, .resins = &stack.resins};
    const optics::Surface whole = optics::find_surface(
        scene, optics::cell_voxels(stack.volume.pitch_mm(), effort.cell_mm), optics::SurfacePart::all);
    BodyJudgement result;
    result.surface_cells = static_cast<double>(whole.cells.size());
    Judgement& j = result.cells;
    std::vector<char> thin(whole.cells.size());
    parallel_for(0, thin.size(), 1024, [&](std::size_t i) { thin[i] = is_thin(stack.volume, whole.cells[i]); });
    double thin_area = 0, area = 0;
    for (std::size_t i = 0; i < thin.size(); ++i) {
        area += static_cast<double>(whole.cells[i].area_mm2);
        if (thin[i]) thin_area += static_cast<double>(whole.cells[i].area_mm2);
    }
    result.thin_share = thin_area / area;
    const auto target_of = [&](const optics::Surface& surface) {
        return slicer::target_of_cells(surface, stack.volume.pitch_mm(), body.grid.origin_mm, body.surface,
                                       body.model.mesh, nullptr);
    };
    const std::vector<std::size_t> centres =
        choice.solids > 0 ? draw_in_solids(whole, target_of(whole), choice, result) : draw_centres(whole, thin, choice);
    if (centres.empty()) return result;  // a body without a solid of flat colour
    j.surface = take_windows(whole, thin, centres, choice, result);
    j.target = target_of(j.surface);
    map_target(options, std::nullopt, j);

    const auto start = std::chrono::steady_clock::now();
    const slicer::MeshBoundary boundary(body.surface->positions_mm, body.surface->triangles, body.grid.origin_mm);
    const std::string digest = volume_digest(stack.volume);
    // The boundary is a function of the model and of how it was placed.
    const std::string boundary_name =
        fmt::format("{} {} {} triangles", options.model, options.size_mm, body.surface->triangles.size());
    std::array<std::vector<float>, 2> value;
    for (std::size_t h = 0; h < 2; ++h)
        value[h] = traced(scene, digest, j.surface, {effort.paths, h + 1, &boundary, boundary_name}, effort.cache);
    const optics::ResinVolume twin = optics::all_of(stack.volume, static_cast<optics::Material>(stack.white + 1));
    optics::Scene white_scene = scene;
    white_scene.volume = &twin;
    std::vector<float> white = traced(white_scene, volume_digest(twin), j.surface,
                                      {effort.white_paths, 3, &boundary, boundary_name}, effort.cache);
    const optics::ObservedColour<float> observed(stack.resins.channels);
    const std::size_t channels = observed.channels();
    smooth_white(j.surface, white, channels, effort.cell_mm);
    j.trace_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (std::size_t h = 0; h < 2; ++h)
        for (std::size_t i = 0; i < j.surface.cells.size(); ++i)
            j.half[h].push_back(observed.relative(value[h].data() + i * channels, white.data() + i * channels));
    return result;
}

}  // namespace voxtone::loop_benchmark
