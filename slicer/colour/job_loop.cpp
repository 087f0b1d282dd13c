// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/job_loop.h"

#include <algorithm>
#include <filesystem>
#include <future>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/stop_deadline.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/disk/scratch_file.h"
#include "slicer/colour/skin_gradient.h"
#include "slicer/options/model_choice.h"

namespace voxtone::slicer {

namespace {

/// All of the white resin, but for what is clear over and under it.
optics::ResinVolume shape_of(const PrintParts& parts, const JobColour& colour, std::uint64_t print_bytes,
                             const Progress& progress) {
    return parts.shape(static_cast<optics::Material>(colour.appearance.geometry().white() + 1), print_bytes, progress);
}

/// A loop by feedback alone needs no gradient of what lies deep: cells in the blocks that light enters and in their
/// margin, nodes below. With 0.8, 0.4 and 0.15 the bundled cow of 40 mm comes to the same error, and so does the suite
/// (docs/decisions/006). Not on a sheet, where a loop descends.
constexpr double cells_of_feedback_mm = 0.15;

bool wants_deep_colour_in_nodes(const LoopPlan& plan, const optics::Scene& scene) {
    return !plan.descent && scene.backing == optics::Backing::none;
}

std::unique_ptr<const optics::AppearanceModel> loop_model(const ResolvedJob& job, bool deep_in_nodes, double colour_mm,
                                                          std::uint64_t memory_bytes,
                                                          const std::filesystem::path& scratch_folder) {
    ModelOptions quality;
    quality.cell_mm = job.prediction.cell_mm;
    quality.viewing_cells = true;
    quality.colour_mm = deep_in_nodes ? std::min(colour_mm, cells_of_feedback_mm) : colour_mm;
    quality.deep_colour_in_nodes = deep_in_nodes;
    quality.memory_bytes = memory_bytes;
    quality.scratch = [scratch_folder] { return std::make_unique<io::ScratchFile>(scratch_folder); };
    quality.seed = job.seed;
    constexpr std::uint32_t paths = 256;  // noise goes straight into the halftone
    quality.paths = paths;
    quality.from_behind = job.picture.is_lit_from_behind();
    return make_model(job.loop.model, quality);
}

/// Keeps the state of the loop while the next print is made: after each iteration, or, where writing takes longer than
/// anybody would notice, as often as a sixtieth of the loop's time allows. A state that cannot be written is no reason
/// to stop.
class CheckpointKeeper {
public:
    CheckpointKeeper(const LoopCheckpoint& checkpoint, Progress& progress)
        : checkpoint_(checkpoint), progress_(progress) {}
    CheckpointKeeper(const CheckpointKeeper&) = delete;
    CheckpointKeeper& operator=(const CheckpointKeeper&) = delete;
    /// Waits for what is being written.
    ~CheckpointKeeper() = default;

    /// Both stay as they are until `finish` comes back.
    void keep(const halftone::LoopState& state, const optics::AppearanceSequence& sequence) {
        finish();
        if (write_s_ > unnoticed_s && since_write_.total() < share_of_writing * write_s_) return;
        since_write_ = {};
        writing_ = std::async(std::launch::async, [this, &state, &sequence] {
            checkpoint_.write(state, sequence);
            write_s_ = since_write_.total();
            set_stop_advice(LoopCheckpoint::advice(checkpoint_.file().parent_path()));
        });
    }
    /// The last state is written then, or it was said that it could not be.
    void finish() {
        if (!writing_.valid()) return;
        try {
            writing_.get();
        } catch (const Error& error) {
            if (std::exchange(warned_, true)) return;
            progress_.warn(named_warning(
                "not-resumable",
                fmt::format("{} The loop goes on, but if it is interrupted it cannot be resumed from here",
                            error.what())));
        }
    }

private:
    static constexpr double share_of_writing = 60, unnoticed_s = 0.05;

    const LoopCheckpoint& checkpoint_;
    Progress& progress_;
    bool warned_ = false;
    Stopwatch since_write_;
    double write_s_ = 0;  ///< of the last one
    std::future<void> writing_;
};

/// The skin's voxels, found when they are first asked for.
class KeptSkin {
public:
    KeptSkin(const LoopProblem& problem, const Progress& progress) : problem_(problem), progress_(progress) {}
    /// Null where memory is short: it is for light.
    [[nodiscard]] const SkinVoxels* find() {
        if (!std::exchange(looked_, true))
            voxels_ = problem_.parts.skin_voxels(problem_.cells->map(),
                                                 problem_.job.prediction.memory_bytes / share_of_memory, progress_);
        return voxels_ ? &*voxels_ : nullptr;
    }

private:
    static constexpr std::uint64_t share_of_memory = 32;
    const LoopProblem& problem_;
    const Progress& progress_;
    std::optional<SkinVoxels> voxels_;
    bool looked_ = false;
};

/// Of a picture the loop sees the face alone (viewed_cells.cpp). Of the print by visible triangle.
std::vector<char> not_looked_at(const JobBody& body) {
    std::vector<char> apart;
    if (!body.is_picture) return apart;
    constexpr double up = 0.5;
    const VisibleSurface& surface = *body.surface;
    for (const auto& triangle : surface.triangles) {
        const auto at = [&](std::size_t c) -> const Eigen::Vector3d& { return surface.positions_mm[triangle[c]]; };
        const Eigen::Vector3d out = (at(1) - at(0)).cross(at(2) - at(0));
        apart.push_back(out.z() < up * out.norm());
    }
    return apart;
}

}  // namespace

LoopCells::LoopCells(ViewedCells cells, const JobBody& body, const DepthZones& of_zones, double colour_mm)
    : seen(std::move(cells)),
      zones(of_zones),
      layers(halftone::skin_layers(colour_mm)),
      places(*body.surface, body.grid.origin_mm),
      index(seen.surface, {body.grid.pitch_mm.x(), body.grid.pitch_mm.y(), body.grid.pitch_mm.z()}),
      apart(not_looked_at(body)) {}

LoopProblem::LoopProblem(const ResolvedJob& of_job, const JobBody& body, const LoadedResins& of_resins,
                         const JobColour& colour, const PrintParts& of_parts, const Progress& progress)
    : job(of_job),
      resins(of_resins),
      parts(of_parts),
      print_bytes(job.prediction.memory_bytes / 3),
      white(colour.appearance.geometry().white()),
      shape(shape_of(parts, colour, print_bytes, progress)),
      scene(scene_of(shape, resins, body, job.picture.backing)),
      cells(std::make_shared<const LoopCells>(find_viewed_cells(scene, body, job.prediction.cell_mm, progress), body,
                                              parts.zones(), colour.appearance.geometry().shell_mm)),
      recipes(prepare_recipes(colour.appearance, cells->layers)) {}

SavedSkin saved_skin(const JobLoop& loop) {
    SavedSkin skin;
    skin.model = loop.model;
    skin.seconds = loop.seconds;
    skin.surface.cell_voxels = loop.cells->seen.surface.cell_voxels;
    skin.surface.cells = loop.cells->seen.surface.cells;
    for (optics::SurfaceCell& cell : skin.surface.cells) cell.first_face = cell.faces = 0;
    skin.target = loop.cells->seen.target;
    skin.cell_um = loop.cells->seen.cell_um;
    skin.result = loop.result;
    skin.mixtures = loop.mixtures;
    return skin;
}

JobLoop loop_of(SavedSkin skin, const JobBody& body, const DepthZones& zones, double colour_mm) {
    JobLoop loop;
    loop.model = std::move(skin.model);
    loop.seconds = skin.seconds;
    loop.cells = std::make_shared<const LoopCells>(
        ViewedCells{std::move(skin.surface), std::move(skin.target), skin.cell_um}, body, zones, colour_mm);
    loop.result = std::move(skin.result);
    loop.mixtures = std::move(skin.mixtures);
    loop.reread = true;
    return loop;
}

JobLoop run_job_loop(const LoopProblem& problem, const LoopPlan& plan, const LoopCheckpoint& checkpoint,
                     std::optional<halftone::ResumedLoop> before, Progress& progress) {
    const Stopwatch watch;
    const ResolvedJob& job = problem.job;
    const LoopCells& cells = *problem.cells;
    const SkinMap map = cells.map();
    const auto model = loop_model(job, wants_deep_colour_in_nodes(plan, problem.scene), cells.layers.depth_mm(),
                                  bytes_for_predictions(job.prediction.memory_bytes, cells.seen.surface.cells.size()),
                                  checkpoint.file().parent_path());
    const auto print = [&](const SkinSource* skin) {
        return problem.parts.volume(skin, problem.print_bytes, progress);
    };

    halftone::LoopTask task;
    task.model = model.get();
    task.scene = problem.scene;
    task.white_resin = problem.white;
    task.surface = &cells.seen.surface;
    task.recipes = problem.recipes.get();
    task.target = cells.seen.target;
    KeptSkin kept(problem, progress);
    task.open_loop = [&] {
        if (plan.iterations != 0) (void)kept.find();  // while no light is kept yet
        return print(nullptr);
    };
    task.realise = [&](const halftone::SkinMixtures& mixtures) {
        if (const SkinVoxels* skin = kept.find())
            return problem.parts.volume(*skin, mixtures, problem.shape, problem.print_bytes, progress);
        const SkinSource skin(map, mixtures, problem.resins.core);
        return print(&skin);
    };
    task.mixture_gradient = [&](const auto& visit_all) {
        const SkinVoxels* voxels = problem.parts.translucency() ? nullptr : kept.find();
        return skin_gradient(problem.parts, map, voxels, cells.seen.surface.cells.size(),
                             problem.resins.set.resins.size(), visit_all, progress);
    };
    halftone::LoopOptions options;
    options.iterations = plan.iterations;
    if (plan.patient) options.most_without_limit = halftone::patient_iterations;
    options.viewing_distance_mm = job.loop.viewing_distance_mm;
    options.intent = job.loop.intent;
    options.descent = plan.descent;
    options.last_look = plan.last_look;

    JobLoop loop;
    loop.model = name_of(job.loop.model);
    loop.cells = problem.cells;
    CheckpointKeeper keeper(checkpoint, progress);
    const auto keep = [&](const halftone::LoopState& state, const optics::AppearanceSequence& sequence) {
        keeper.keep(state, sequence);
        return [&keeper] { keeper.finish(); };
    };
    loop.result = halftone::run_appearance_loop(task, options, progress, keep, std::move(before));
    keeper.finish();
    if (loop.result.cancelled) throw Cancelled();
    if (loop.result.best) loop.mixtures = halftone::cumulative_mixtures(*loop.result.best);
    loop.result.best.reset();
    loop.seconds = watch.total();
    return loop;
}

}  // namespace voxtone::slicer
