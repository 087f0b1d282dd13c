// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/job_loop.h"

#include <algorithm>
#include <future>
#include <utility>

#include <fmt/core.h>

#include "voxtone/base/error.h"
#include "voxtone/base/stop_deadline.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/slicer/job/skin_gradient.h"
#include "voxtone/slicer/options/auto_limits.h"
#include "voxtone/slicer/options/model_choice.h"

namespace voxtone::slicer {

namespace {

/// All of the white resin, or of the core where there is none: the open loop's print is made again when it is looked
/// at.
optics::ResinVolume shape_of(const PrintParts& parts, const LoadedResins& resins, std::uint64_t print_bytes,
                             const Progress& progress) {
    const int white = resins.set.find("W");
    return optics::all_of(parts.volume(nullptr, print_bytes, progress),
                          static_cast<optics::Material>((white >= 0 ? white : resins.core) + 1));
}

std::unique_ptr<const halftone::MinimalDepthSeparation> make_recipes(const optics::ResinSet& resins,
                                                                     const optics::ShellGeometry& shell,
                                                                     const halftone::SkinLayers& layers,
                                                                     const Progress& progress) {
    optics::ShellGeometry below = shell;
    below.core_mm += shell.shell_mm - layers.depth_mm();
    halftone::SeparationOptions separation;
    separation.wavelengths_nm = resins.channels.wavelengths_nm;
    constexpr int nodes = 33;
    separation.nodes = nodes;
    return std::make_unique<const halftone::MinimalDepthSeparation>(resins, below, layers, separation, &progress);
}

std::unique_ptr<const optics::AppearanceModel> loop_model(const ResolvedJob& job, double colour_mm,
                                                          std::uint64_t memory_bytes) {
    ModelOptions quality;
    quality.cell_mm = job.prediction.cell_mm;
    quality.viewing_cells = true;
    quality.colour_mm = colour_mm;
    quality.memory_bytes = memory_bytes;
    quality.seed = job.seed;
    constexpr std::uint32_t paths = 256;  // noise goes straight into the halftone
    quality.paths = paths;
    return make_model(job.loop.model, quality);
}

/// Keeps the state of the loop after each iteration, while the next print is made; a state that cannot be written is no
/// reason to stop.
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
        writing_ = std::async(std::launch::async, [this, &state, &sequence] {
            checkpoint_.write(state, sequence);
            tell_how_to_go_on();
        });
    }
    /// The last state is written then, or it was said that it could not be.
    void finish() {
        if (!writing_.valid()) return;
        try {
            writing_.get();
        } catch (const Error& error) {
            if (std::exchange(warned_, true)) return;
            progress_.warn(fmt::format("{} The loop goes on, but if it is interrupted it cannot be resumed from here",
                                       error.what()));
        }
    }

private:
    void tell_how_to_go_on() const {
        set_stop_advice(
            fmt::format("the appearance loop is saved in {}: the same command with --resume goes on, with --resume "
                        "--iterations 0 it prints the best that there is",
                        checkpoint_.file().string()));
    }

    const LoopCheckpoint& checkpoint_;
    Progress& progress_;
    bool warned_ = false;
    std::future<void> writing_;
};

}  // namespace

LoopPlan plan_loop(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins) {
    const JobLoopOptions& options = job.loop;
    const auto none = [](std::string why_not) { return LoopPlan{.why_not = std::move(why_not)}; };
    if (options.iterations == 0 && !job.resume) return none("");
    if (resins.set.resins.size() < 2)
        return none("The resins were not rearranged: one resin alone leaves nothing to choose.");
    if (body.surface->triangles.empty())
        return none("The resins were not rearranged: the body has no coloured surface.");
    const double area_mm2 = coloured_area_mm2(*body.surface);
    LoopPlan plan{.wanted = true,
                  .iterations = options.iterations.value_or(-1),
                  .descent = options.method == LoopMethod::descent ||
                             (options.method == LoopMethod::automatic && area_mm2 <= 100 * descent_cm2),
                  .why_not = ""};
    const double bytes = expected_cost(plan, area_mm2, job.prediction.cell_mm).bytes,
                 allowed = double(job.prediction.memory_bytes);
    if (!options.iterations && !job.resume && allowed > 0 && bytes > cost_factor * allowed)
        return none(
            fmt::format("The resins were not rearranged: for {:.0f} cm2 of coloured surface that would take about "
                        "{:.1f} GB of memory, and {:.1f} are allowed. Allow more (--memory), take larger cells "
                        "(--predict-cell), or ask for it all the same (--iterations N).",
                        area_mm2 / 100, bytes / 1e9, allowed / 1e9));
    return plan;
}

LoopCost expected_cost(const LoopPlan& plan, double area_mm2, double cell_mm) {
    // Of `slice` with the bundled cow at 15, 30 and 60 mm and a photograph 20 mm wide.
    constexpr double first_s = 7e-5, feedback_s = 1.4e-5, descent_s = 3.4e-5;         // a surface cell
    constexpr double least_bytes = 3e8, feedback_bytes = 2900, descent_bytes = 4500;  // a surface cell
    constexpr int usual_by_feedback = 4, usual_by_descent = 12;
    const double cells = area_mm2 / (cell_mm * cell_mm);
    LoopCost cost;
    cost.iterations = plan.iterations >= 0 ? plan.iterations : plan.descent ? usual_by_descent : usual_by_feedback;
    const int by_feedback = plan.descent ? std::min(cost.iterations, halftone::feedback_iterations) : cost.iterations;
    cost.seconds = cells * (first_s + by_feedback * feedback_s + (cost.iterations - by_feedback) * descent_s);
    cost.bytes = least_bytes + cells * (plan.descent ? descent_bytes : feedback_bytes);
    return cost;
}

LoopCells::LoopCells(ViewedCells cells, const JobBody& body, const optics::ResinVolume& volume, double colour_mm)
    : seen(std::move(cells)),
      layers(halftone::skin_layers(colour_mm)),
      places(*body.surface, body.grid.origin_mm),
      index(seen.surface, volume.pitch_mm()) {}

LoopProblem::LoopProblem(const ResolvedJob& of_job, const JobBody& body, const LoadedResins& of_resins,
                         const JobColour& colour, const PrintParts& of_parts, const Progress& progress)
    : job(of_job),
      resins(of_resins),
      parts(of_parts),
      print_bytes(job.prediction.memory_bytes / 3),
      shape(shape_of(parts, resins, print_bytes, progress)),
      scene(scene_of(shape, resins, body, job.picture.backing)),
      cells(std::make_shared<const LoopCells>(find_viewed_cells(scene, body, job.prediction.cell_mm, progress), body,
                                              shape, colour.appearance.geometry().shell_mm)),
      recipes(make_recipes(resins.set, colour.appearance.geometry(), cells->layers, progress)) {}

JobLoop run_job_loop(const LoopProblem& problem, const LoopPlan& plan, const LoopCheckpoint& checkpoint,
                     std::optional<halftone::ResumedLoop> before, Progress& progress) {
    const Stopwatch watch;
    const ResolvedJob& job = problem.job;
    const LoopCells& cells = *problem.cells;
    const SkinMap map = cells.map();
    const auto model = loop_model(job, cells.layers.depth_mm(), job.prediction.memory_bytes - problem.print_bytes);
    const auto print = [&](const SkinSource* skin) {
        return problem.parts.volume(skin, problem.print_bytes, progress);
    };

    halftone::LoopTask task;
    task.model = model.get();
    task.scene = problem.scene;
    task.surface = &cells.seen.surface;
    task.recipes = problem.recipes.get();
    task.target = cells.seen.target;
    task.open_loop = [&] { return print(nullptr); };
    task.realise = [&](const halftone::SkinMixtures& mixtures) {
        const SkinSource skin(map, mixtures, problem.resins.core);
        return print(&skin);
    };
    task.mixture_gradient = [&](const auto& visit_all) {
        return skin_gradient(problem.parts, map, cells.seen.surface.cells.size(), problem.resins.set.resins.size(),
                             visit_all, progress);
    };
    halftone::LoopOptions options;
    options.iterations = plan.iterations;
    options.viewing_distance_mm = job.loop.viewing_distance_mm;
    options.intent = job.loop.intent;
    options.descent = plan.descent;

    JobLoop loop{std::string(name_of(job.loop.model)), problem.cells, {}, 0};
    CheckpointKeeper keeper(checkpoint, progress);
    const auto keep = [&](const halftone::LoopState& state, const optics::AppearanceSequence& sequence) {
        keeper.keep(state, sequence);
        return [&keeper] { keeper.finish(); };
    };
    loop.result = halftone::run_appearance_loop(task, options, progress, keep, std::move(before));
    keeper.finish();
    if (loop.result.cancelled) throw Cancelled();
    loop.seconds = watch.total();
    return loop;
}

}  // namespace voxtone::slicer
