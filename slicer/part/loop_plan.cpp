// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/loop_plan.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/machine_memory.h"
#include "halftone/loop/appearance_loop.h"
#include "slicer/options/auto_limits.h"

namespace voxtone::slicer {

namespace {

constexpr double of_program = 1e8;  // bytes

/// Of the print, the surface and the state of the loop. `slice` with the bundled cow at 60 mm, 1.12 million cells: at
/// most 1.60 GB with --memory 1.25, 2.35 GB without, the same bits.
double held_bytes(double surface_cells) {
    constexpr double of_cell = 950;
    return of_program + of_cell * surface_cells;
}

/// With the tile that is predicted: bodies are halved until tiles are small enough (viewing_tiles.h). The cow's tiles
/// at 20 to 60 mm take 1.1 to 2.5 kB a cell, and predictions want a third more.
double least_bytes(double cells) {
    constexpr double of_tile_cell = 3300, most_tile_cells = 250'000;
    constexpr double stairs = 1.16;  // surface cells / area of the surface in cells
    double tile_cells = stairs * cells;
    while (tile_cells > most_tile_cells) tile_cells /= 2;
    return held_bytes(stairs * cells) + of_tile_cell * tile_cells;
}

}  // namespace

std::string nothing_to_rearrange(const JobBody& body, const LoadedResins& resins) {
    if (resins.set.resins.size() < 2)
        return "The resins were not rearranged: one resin alone leaves nothing to choose.";
    if (body.surface->triangles.empty()) return "The resins were not rearranged: the body has no coloured surface.";
    return {};
}

LoopPlan plan_loop(const OpenedJob& job, const JobBody& body, bool all_white) {
    const JobLoopOptions& options = job.options.loop;
    const JobPredictionOptions& prediction = job.options.prediction;
    const auto none = [](std::string why_not) { return LoopPlan{.why_not = std::move(why_not), .does_not_fit = ""}; };
    if ((options.iterations == 0 || job.run.loop_done) && !job.run.goes_on) return none("");
    if (std::string why_not = nothing_to_rearrange(body, job.resins); !why_not.empty()) return none(std::move(why_not));
    if (all_white && !options.iterations)
        return none(
            "The model is white all over and the print all of white resin: there is nothing to rearrange and nothing "
            "to predict.");
    const double area_mm2 = coloured_area_mm2(*body.surface);
    const bool gains_downhill = body.is_picture || options.intent == halftone::Intent::contrast;
    LoopPlan plan{.wanted = true,
                  .iterations = options.iterations.value_or(-1),
                  .patient = options.patient,
                  // A gradient knows nothing of the clear resin that alpha lays between the others.
                  .descent = !has_alpha(body.model.mesh) && (options.method == LoopMethod::descent ||
                                                             (options.method == LoopMethod::automatic &&
                                                              gains_downhill && area_mm2 <= 100 * descent_cm2)),
                  .why_not = "",
                  .does_not_fit = ""};
    const double cell_mm = prediction.cell_mm, bytes = least_bytes(area_mm2 / (cell_mm * cell_mm)),
                 allowed = double(prediction.memory_bytes);
    if (!options.iterations && !job.run.goes_on && allowed > 0 && bytes > allowed)
        plan.does_not_fit = fmt::format(
            "{}: the appearance loop on {:.0f} cm2 of coloured surface takes {} of memory at the least, and {} are "
            "allowed: allow more (--memory), take larger cells (--predict-cell), print without it "
            "(--iterations 0), or try it all the same (--iterations N)",
            job.options.model, area_mm2 / 100, memory_text(static_cast<std::uint64_t>(bytes)),
            memory_text(prediction.memory_bytes));
    return plan;
}

bool prints_all_white(const SurfaceColour& target, const LoadedResins& resins) {
    return target.constant() && target.at(0, 0, 0) == Eigen::Vector3f::Ones() &&
           resins.set.resins[std::size_t(resins.core)].role == "W";
}

std::uint64_t bytes_for_predictions(std::uint64_t allowed_bytes, std::size_t surface_cells) {
    const double left = double(allowed_bytes) - held_bytes(double(surface_cells));
    return static_cast<std::uint64_t>(std::max(left, double(allowed_bytes) / 3));
}

LoopCost expected_cost(const LoopPlan& plan, double area_mm2, double cell_mm, std::uint64_t allowed_bytes) {
    // Of `slice` with bodies of 15 to 60 mm and a photograph 20 mm wide (docs/estimate.md).
    constexpr double first_s = 1e-4, feedback_s = 2.3e-5, descent_s = 5.3e-5;  // a surface cell
    constexpr double feedback_bytes = 2900, descent_bytes = 4500;              // a surface cell, where not limited
    constexpr double when_short = 1.1;                                         // to the disk and back
    constexpr double on_disk = 1100;                                           // a surface cell, of four channels
    constexpr int usual_by_feedback = 4, usual_by_descent = halftone::most_iterations;
    const double cells = area_mm2 / (cell_mm * cell_mm);
    LoopCost cost;
    cost.iterations = plan.iterations >= 0 ? plan.iterations
                      : !plan.descent      ? usual_by_feedback
                      : plan.patient       ? halftone::patient_iterations
                                           : usual_by_descent;
    const int by_feedback = plan.descent ? std::min(cost.iterations, halftone::feedback_iterations) : cost.iterations;
    const int feedback_like = by_feedback + (plan.last_look ? 1 : 0);
    cost.cpu_seconds = cells * (first_s + feedback_like * feedback_s + (cost.iterations - by_feedback) * descent_s);
    const double bytes = of_program + cells * (plan.descent ? descent_bytes : feedback_bytes);
    if (allowed_bytes == 0) return cost;
    cost.most_bytes = std::max(double(allowed_bytes), least_bytes(cells));
    if (bytes <= double(allowed_bytes)) return cost;
    cost.cpu_seconds *= when_short;
    cost.disk_bytes = cells * on_disk;
    return cost;
}

}  // namespace voxtone::slicer
