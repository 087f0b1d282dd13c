// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/job_loop.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "voxtone/base/error.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/slicer/job/loop_checkpoint.h"
#include "voxtone/slicer/job/skin_gradient.h"
#include "voxtone/slicer/options/model_choice.h"
#include "voxtone/slicer/predict/stack_volume.h"
#include "voxtone/slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

halftone::Intent parse_intent(const std::string& name) {
    return name == "absolute"   ? halftone::Intent::absolute
           : name == "contrast" ? halftone::Intent::contrast
                                : halftone::Intent::relative;
}

std::unique_ptr<const optics::AppearanceModel> loop_model(const SliceOptions& options, double colour_mm,
                                                          std::uint64_t memory_bytes) {
    ModelOptions quality;
    quality.cell_mm = options.predict_cell_mm;
    quality.viewing_cells = true;
    quality.colour_mm = colour_mm;
    quality.memory_bytes = memory_bytes;
    quality.seed = options.seed;
    constexpr std::uint32_t paths = 256;  // noise goes straight into the halftone
    quality.paths = paths;
    return make_model(options.loop_model, quality);
}

}  // namespace

LoopPlan plan_loop(const SliceOptions& options, const JobBody& body, const LoadedResins& resins) {
    const int iterations = parse_iterations(options.iterations);
    if (iterations == 0) return {};
    if (resins.set.resins.size() < 2)
        return {0, "The resins were not rearranged: one resin alone leaves nothing to choose."};
    if (body.surface->triangles.empty())
        return {0, "The resins were not rearranged: the body has no coloured surface."};
    const double cm2 = coloured_area_mm2(*body.surface) / 100;
    if (options.iterations == "auto" && cm2 > auto_loop_cm2)
        return {
            0,
            fmt::format(
                "The resins were not rearranged: the coloured surface has {:.0f} cm2, and more than {:g} cm2 are not "
                "without being asked; ask with --iterations N.",
                cm2, auto_loop_cm2)};
    return {iterations, ""};
}

JobLoop::JobLoop(const SliceOptions& options, const LoopPlan& plan, const JobBody& body, const LoadedResins& resins,
                 const JobColour& colour, const PrintParts& parts, const std::filesystem::path& folder,
                 Progress& progress)
    : model(options.loop_model), places_(*body.surface, body.grid.origin_mm) {
    const Stopwatch watch;
    progress.begin_stage("prepare the loop", 0);
    const std::uint64_t memory = memory_budget(options.memory_gib);
    const int white = resins.set.find("W");
    // The shape takes little memory where it is all white; the open loop's print is made again when it is looked at.
    const optics::ResinVolume shape =
        optics::all_of(parts.volume(nullptr, memory / 3, progress),
                       static_cast<optics::Material>((white >= 0 ? white : resins.core) + 1));
    const optics::Scene scene{.volume = &shape,
                              .resins = &resins.set,
                              .backing = body.is_picture ? parse_backing(options.backing) : optics::Backing::none};
    const auto cell = optics::cell_voxels(shape.pitch_mm(), options.predict_cell_mm);
    for (std::size_t a = 0; a < 3; ++a) cell_um[a] = cell[a] * shape.pitch_mm()[a] * 1e3;
    surface = optics::find_surface(scene, cell, body.is_picture ? optics::SurfacePart::top : optics::SurfacePart::all);
    target = target_of_cells(surface, shape.pitch_mm(), body.grid.origin_mm, body.surface, body.model.mesh, &progress);
    cells_.emplace(surface, shape.pitch_mm());

    const optics::ShellGeometry& shell = colour.appearance.geometry();
    layers_ = halftone::skin_layers(shell.shell_mm);
    optics::ShellGeometry below = shell;
    below.core_mm += shell.shell_mm - layers_.depth_mm();
    halftone::SeparationOptions separation;
    separation.wavelengths_nm = resins.set.channels.wavelengths_nm;
    constexpr int nodes = 33;
    separation.nodes = nodes;
    recipes_ = std::make_unique<const halftone::SurfaceFirst>(resins.set, below, layers_, separation, &progress);
    progress.end_stage();

    const auto forward = loop_model(options, layers_.depth_mm(), memory - memory / 3);
    halftone::LoopTask task;
    task.model = forward.get();
    task.scene = scene;
    task.surface = &surface;
    task.recipes = recipes_.get();
    task.target = target;
    task.open_loop = [&] { return parts.volume(nullptr, memory / 3, progress); };
    const SkinMap map{places_, *cells_, layers_};
    task.realise = [&](const halftone::SkinMixtures& mixtures) {
        const SkinSource skin(map, mixtures, resins.core);
        return parts.volume(&skin, memory / 3, progress);
    };
    task.by_mixtures = [&](const auto& visit_all) {
        return skin_gradient(parts, map, surface.cells.size(), resins.set.resins.size(), visit_all, progress);
    };
    halftone::LoopOptions loop;
    loop.iterations = plan.iterations;
    loop.viewing_distance_mm = options.viewing_distance_mm;
    loop.intent = parse_intent(options.intent);
    loop.descent = options.loop_method == "descent" ||
                   (options.loop_method == "auto" && coloured_area_mm2(*body.surface) <= 100 * descent_cm2);
    const LoopCheckpoint checkpoint(folder, options, target);
    const std::optional<halftone::LoopState> before = options.resume ? checkpoint.read(progress) : std::nullopt;
    result = halftone::run_appearance_loop(
        task, loop, progress, [&](const halftone::LoopState& state) { checkpoint.write(state); },
        before ? &*before : nullptr);
    if (result.cancelled) {
        // What was found is printed all the same; the next Ctrl-C ends the program at once.
        progress.forgive();
        progress.note(fmt::format(
            "stopped: the layers of the best iteration so far ({}) are written now; Ctrl-C again ends at once",
            result.state.steps[result.state.best].iteration));
    } else {
        checkpoint.remove();
    }
    if (result.best) skin_.emplace(map, *result.best, resins.core);
    seconds = watch.total();
}

}  // namespace voxtone::slicer
