// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/predicted_stack.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "base/job_outlook.h"
#include "base/machine_memory.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "optics/grid/block_contrast.h"
#include "slicer/look/coarse_cells.h"
#include "slicer/look/prediction_time.h"
#include "slicer/part/backing_sheet.h"
#include "slicer/predict/parts_in_sight.h"
#include "slicer/predict/stack_boundary.h"

namespace voxtone::slicer {

namespace {

double voxels_of(const StackHead& head) { return double(head.size[0]) * head.size[1] * head.size[2]; }

/// A slab of a picture, and a box that is not higher than it is wide, are looked at from above.
bool is_flat(const StackHead& head) {
    std::array<double, 3> mm{};
    for (std::size_t a = 0; a < 3; ++a) mm[a] = head.size[a] * head.pitch_mm[a];
    return head.of_picture || (double(head.solid_voxels) == voxels_of(head) && mm[2] <= std::min(mm[0], mm[1]));
}

bool seen_from_above(const ResolvedPrediction& job, const StackHead& head) {
    return job.view == PredictedView::top || (job.view == PredictedView::automatic && is_flat(head));
}

std::uint64_t surface_bytes(const optics::Surface& surface) {
    return surface.cells.size() * (sizeof(optics::SurfaceCell) + sizeof(float) * 3) +
           surface.faces.size() * sizeof(optics::SurfaceFace);
}

/// Before anything is read: a body has half the surface of its box, about; of a slab the top is seen.
double guessed_area_mm2(const std::array<int, 3>& voxels, const std::array<double, 3>& pitch_mm, PredictedView view) {
    std::array<double, 3> edge{};
    for (std::size_t a = 0; a < 3; ++a) edge[a] = voxels[a] * pitch_mm[a];
    const double top = edge[0] * edge[1];
    const bool slab = 5 * edge[2] < std::min(edge[0], edge[1]);
    if (view == PredictedView::top || (view == PredictedView::automatic && slab)) return top;
    return top + edge[2] * (edge[0] + edge[1]);
}

/// The stages that are still to come, for the time that is shown as left; `read_s`: of the layers, 0 where they are
/// read, as then nothing is known of the resins (null).
void expect_rest(const ResolvedPrediction& job, double read_s, double area_mm2, const std::array<double, 3>& pitch_mm,
                 const optics::ResinSet* resins, Progress& progress) {
    // Two cores of 2.5 GHz, by `voxtone predict` of the bundled cow at 15 and 30 mm.
    constexpr double surface_s_per_mm2 = 3e-4, write_s_per_mm2 = 5e-4;
    ModelOptions quality = job.requested.quality;
    quality.cell_mm = job.requested.cell_mm;
    quality.viewing_cells = resins && !optics::voxels_are_apart(*resins);
    constexpr std::size_t usual_channels = 3;  // what the resins have is known with the layers
    const std::size_t channels = resins ? resins->channels.size() : usual_channels;
    std::vector<ExpectedStage> stages;
    if (read_s > 0) {
        stages.push_back({"read layers", read_s});
        stages.push_back({"find the surface", surface_s_per_mm2 * area_mm2});
    }
    stages.push_back({"predict", prediction_seconds(job.model, quality, pitch_mm, area_mm2, channels)});
    stages.push_back({"write", write_s_per_mm2 * area_mm2});
    expect_stages(progress, std::move(stages));
}

/// Cells of a larger size than the eye's are put together from the eye's.
std::optional<CoarseCells> quick_cells(const ResolvedPrediction& job, const std::array<double, 3>& pitch_mm) {
    if (job.model != PredictionModel::transport) return std::nullopt;
    return coarse_cells(pitch_mm, job.requested.cell_mm);
}

ModelOptions model_options(const ResolvedPrediction& job, bool quick, std::uint64_t memory_bytes) {
    ModelOptions quality = job.requested.quality;
    quality.cell_mm = quick ? eye_cell_mm : job.requested.cell_mm;
    quality.viewing_cells = quick;
    quality.memory_bytes = memory_bytes;
    return quality;
}

/// By what is held of any body of this size: the least of its volume, of its surface and of the model, which takes
/// smaller tiles where there is little left.
void expect_memory(const ResolvedPrediction& job, const StackHead& head) {
    constexpr double edge = optics::ResinVolume::block_edge, block_voxels = edge * edge * edge;
    const double volume = voxels_of(head) / block_voxels * sizeof(std::int32_t);
    // A column holds a voxel per layer at most, and has an upper face.
    const double surface = double(head.solid_voxels) / head.size[2] * sizeof(optics::SurfaceFace);
    const double solid_mm3 = double(head.solid_voxels) * head.pitch_mm[0] * head.pitch_mm[1] * head.pitch_mm[2];
    const bool quick = quick_cells(job, head.pitch_mm).has_value();
    const std::uint64_t model =
        least_model_bytes(job.model, model_options(job, quick, job.memory_bytes), solid_mm3, head.pitch_mm);
    const double needed = volume * (job.requested.absolute ? 1 : 2) + surface + double(model);
    if (needed <= double(job.memory_bytes)) return;
    throw ResourceError(fmt::format(
        "{}: a prediction of its {} x {} x {} voxels needs at least {}, more than the {} allowed; "
        "allow more (--memory), {}or predict a smaller print",
        job.requested.stack, head.size[0], head.size[1], head.size[2], memory_text(static_cast<std::uint64_t>(needed)),
        memory_text(job.memory_bytes), quick ? "" : "take larger cells (--cell 0.2mm), "));
}

void expect_white(const ResolvedPrediction& job, const StackHead& head) {
    if (job.requested.absolute || head.has_white) return;
    throw InputError(
        fmt::format("the resin set '{}' has no white (role W) for media-relative values to refer to; name another "
                    "set with --resins, or give --absolute",
                    head.resin_set));
}

struct ReadStack {
    StackHead head;
    StackVolume volume;
};

/// All that the head of the stack can refuse is refused before its layers are read.
ReadStack read_stack(const ResolvedPrediction& job, Progress& progress) {
    const PredictOptions& options = job.requested;
    ReadStack stack;
    const auto check_head = [&](const StackHead& head) {
        constexpr double read_s_per_voxel = 1e-8;
        stack.head = head;
        if (job.only_from_above && !seen_from_above(job, head))
            throw InputError(fmt::format(
                "{}: the stack is a body; photographs are compared with slabs and pictures so far, which are flat: see "
                "a body from the camera's place with `voxtone proof {} --camera X,Y,Z`, and compare by eye",
                job.requested.stack, job.requested.stack));
        expect_white(job, head);
        expect_files_fit(job, seen_from_above(job, head));
        expect_memory(job, head);
        expect_rest(job, read_s_per_voxel * voxels_of(head), guessed_area_mm2(head.size, head.pitch_mm, job.view),
                    head.pitch_mm, nullptr, progress);
    };
    // The volume and, for relative values, its white twin are held at once.
    stack.volume = read_stack_volume({.stack = options.stack,
                                      .resins = options.resins,
                                      .illuminant = options.illuminant,
                                      .printer = options.printer,
                                      .pitch_mm = job.pitch_mm,
                                      .assign = job.assign,
                                      .nearest = options.nearest,
                                      .memory_bytes = job.memory_bytes / (options.absolute ? 1 : 2),
                                      .below_coat = true,
                                      .before_reading = check_head},
                                     progress);
    // As it is, whatever a manifest says.
    stack.head.solid_voxels = std::uint64_t(voxels_of(stack.head)) - stack.volume.volume.count()[optics::air];
    return stack;
}

/// From where it is seen, and over what.
void look_from(const ResolvedPrediction& job, const ReadStack& stack, PredictFigures& figures) {
    figures.from_above = seen_from_above(job, stack.head);
    const BackingChoice usual = figures.from_above ? optics::Backing::black : optics::Backing::none;
    figures.backing = job.backing.value_or(stack.volume.backing.value_or(usual));
    const bool by_job = stack.volume.from_behind && !job.backing;
    figures.from_behind = figures.from_above && job.from_behind.value_or(by_job);
    if (figures.from_behind) figures.backing = optics::Backing::none;
}

/// Where light paths leave the body: nothing for its voxels' faces. Throws InputError where the mesh was asked for and
/// cannot be had.
std::optional<MeshBoundary> find_boundary(const ResolvedPrediction& job, const StackVolume& stack,
                                          const PredictFigures& figures, Progress& progress) {
    if (job.model != PredictionModel::monte_carlo || job.boundary == BodyEnd::voxels) return std::nullopt;
    StackBoundary found;
    if (figures.backing.kind != optics::Backing::none)
        found.why_not = "what lies on a sheet ends there, and light paths know sheets under voxels alone";
    else
        found = boundary_of_stack(job.requested.stack, stack, progress);
    if (found.mesh) return std::move(found.mesh);
    if (job.boundary == BodyEnd::mesh)
        throw InputError(fmt::format("--boundary mesh: {}; give --boundary voxels, or slice again", found.why_not));
    if (figures.backing == optics::Backing::none)
        progress.warn(named_warning(
            "voxel-surface",
            fmt::format("light leaves at the faces of the voxels, which shows slanting faces up to 7 CIEDE2000 "
                        "too light, and not at the mesh: {}",
                        found.why_not)));
    return std::nullopt;
}

optics::SurfacePart seen_part(const PredictFigures& figures) {
    return figures.from_above ? optics::SurfacePart::top : optics::SurfacePart::all;
}

/// For models that take each place by itself; nothing where light between parts is not asked for, or followed by paths.
std::optional<PartsInSight> find_parts_in_sight(const ResolvedPrediction& job, const optics::ResinVolume& volume,
                                                const optics::Surface& surface, const PredictFigures& figures,
                                                Progress& progress) {
    if (job.outside != LightOutside::followed || job.model == PredictionModel::monte_carlo) return std::nullopt;
    if (figures.from_above)
        throw InputError(
            "--outside followed: a stack that is seen from above as a picture has no parts that light passes between; "
            "give --view body, or leave it out");
    return PartsInSight(volume, surface, &progress);
}

/// The cells that are predicted, and those that they are averaged over where they are not the same.
struct PredictedCells {
    optics::Surface surface;
    std::optional<optics::Surface> averaged_over;
};

PredictedCells find_cells(const optics::Scene& scene, const ResolvedPrediction& job, PredictFigures& figures,
                          Progress& progress) {
    progress.begin_stage("find the surface", 0);
    const std::array<double, 3>& pitch_mm = scene.volume->pitch_mm();
    const optics::SurfacePart part = seen_part(figures);
    const std::optional<CoarseCells> coarse = quick_cells(job, pitch_mm);
    const auto cell = seen_cell_voxels(pitch_mm, job.requested.cell_mm);
    for (std::size_t a = 0; a < 3; ++a) figures.cell_um[a] = cell[a] * pitch_mm[a] * 1e3;
    PredictedCells cells;
    cells.surface = optics::find_surface(scene, cell, part, &progress);
    if (coarse) {
        cells.averaged_over = std::move(cells.surface);
        cells.surface = optics::find_surface(scene, coarse->eye, part, &progress);
    }
    progress.end_stage();
    return cells;
}

/// Throws ResourceError where more is held than allowed.
void note_memory(const ResolvedPrediction& job, const optics::ResinVolume& volume, std::size_t cells,
                 std::uint64_t held, const PredictFigures& figures, Progress& progress) {
    const auto& size = volume.size();
    const std::uint64_t budget = job.memory_bytes;
    const bool fast = job.model == PredictionModel::transport;
    progress.note(fmt::format(
        "{} x {} x {} voxels and {} surface cells of {:.1f} x {:.1f} x {:.1f} um take {}{} of the {} "
        "allowed (--memory)",
        size[0], size[1], size[2], cells, figures.cell_um[0], figures.cell_um[1], figures.cell_um[2], memory_text(held),
        fast ? fmt::format(", their light up to {},",
                           memory_text(static_cast<std::uint64_t>(prediction_bytes(double(cells)))))
             : "",
        memory_text(budget)));
    if (held <= budget) return;
    throw ResourceError(
        fmt::format("the volume and its surface need {}, more than the {} allowed; allow more "
                    "(--memory), choose larger cells (--cell) or a smaller print",
                    memory_text(held), memory_text(budget)));
}

}  // namespace

PredictedStack predict_stack(const ResolvedPrediction& job, PredictFigures& figures, Progress& progress) {
    const PredictOptions& options = job.requested;
    Stopwatch watch;
    ReadStack read = read_stack(job, progress);
    StackVolume& stack = read.volume;
    figures.read_s = watch.lap();

    look_from(job, read, figures);
    expect_files_fit(job, figures.from_above);
    const auto& voxels = stack.volume.size();
    const auto& pitch_mm = stack.volume.pitch_mm();
    const optics::Scene scene{.volume = &stack.volume,
                              .resins = &stack.resins,
                              .backing = figures.backing.kind,
                              .sheet = sheet_under(figures.backing, {voxels[0] * pitch_mm[0], voxels[1] * pitch_mm[1]},
                                                   stack.resins.channels),
                              .spread_mm = stack.spread_mm};
    const std::uint64_t volumes = stack.volume.memory_bytes() * (options.absolute ? 1 : 2);
    const bool quick = quick_cells(job, stack.volume.pitch_mm()).has_value();
    PredictedCells cells = find_cells(scene, job, figures, progress);
    const std::optional<MeshBoundary> boundary = find_boundary(job, stack, figures, progress);
    figures.boundary = boundary ? BodyEnd::mesh : BodyEnd::voxels;
    const std::optional<PartsInSight> parts = find_parts_in_sight(job, stack.volume, cells.surface, figures, progress);
    figures.surface_s = watch.lap();
    const std::uint64_t held = volumes + surface_bytes(cells.surface) + (parts ? parts->memory_bytes() : 0);
    note_memory(job, stack.volume, cells.surface.cells.size(), held, figures, progress);

    double area_mm2 = 0;
    for (const optics::SurfaceCell& cell : cells.surface.cells) area_mm2 += double(cell.area_mm2);
    expect_rest(job, 0, area_mm2, stack.volume.pitch_mm(), &stack.resins, progress);
    progress.begin_stage("predict", 0);
    ModelOptions quality = model_options(job, quick, job.memory_bytes - held);
    quality.from_behind = figures.from_behind;
    if (!figures.from_behind) set_depth_of_cells(quality, scene.backing);
    quality.boundary = boundary ? &*boundary : nullptr;
    quality.follow_outside = job.outside == LightOutside::followed;
    auto model = make_model(job.model, quality);
    if (parts) model = with_light_between_parts(std::move(model), *parts);
    const std::optional<optics::ResinVolume> white = white_print(stack);
    SurfacePrediction prediction = predict_surface(scene, std::move(cells.surface), *model,
                                                   options.absolute      ? -1
                                                   : figures.from_behind ? stack.clear
                                                                         : stack.white,
                                                   progress, {white && !figures.from_behind ? &*white : nullptr});
    if (quick) prediction = averaged(prediction, std::move(*cells.averaged_over), seen_part(figures));
    progress.end_stage();
    figures.predict_s = watch.lap();
    return {std::move(stack), std::move(prediction)};
}

}  // namespace voxtone::slicer
