// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/phase_estimates.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <utility>

#include "optics/grid/block_contrast.h"
#include "slicer/layers/layer_bytes.h"
#include "slicer/look/prediction_time.h"

namespace voxtone::slicer {

namespace {

// Seconds of a processor of 2.5 GHz: of `voxtone slice` of bodies of 15 to 100 mm and photographs of 15 and 20 mm, with
// and without the loop (docs/estimate.md). Shares that one thread does alone are allowances.
constexpr double separation_s = 0.3;
constexpr double recipes_s = 0.5, preparation_s_per_cell = 1.1e-5;
constexpr double layers_s = 0.4, layers_s_per_voxel = 6e-10, layers_s_per_shell_voxel = 8e-8;
constexpr double predicted_cpu = 1.07;  // of prediction_seconds
constexpr double without_white = 0.6;   // of that, where a loop has seen the body in white
constexpr double report_s = 0.25, seen_s_per_cell = 1.15e-5, drawn_s_per_cell = 2e-6;
constexpr double serial = 0.05;

// Bytes beyond those of the body, above all that was measured in these jobs.
constexpr double work_bytes = 4e7, bytes_per_thread = 8e6;
constexpr double prepared_bytes_per_cell = 900;
constexpr double descent_bytes = 1.6e8, descent_bytes_per_cell = 6400;
constexpr double feedback_bytes = 1.4e8, feedback_bytes_per_cell = 2700;
constexpr double kept_bytes = 5e7, kept_bytes_per_cell = 1800;  // of the loop, while a model predicts
constexpr double topmost_bytes_per_column = 2;                  // io/layers/topmost_layers.h
constexpr double drawn_bytes = 1e8, drawn_bytes_per_cell = 2500;

/// What a job is counted in.
struct Amounts {
    double area_mm2, cells;
    double voxels, shell_voxels;  ///< of the layers that are made
};

Amounts amounts_of(const OpenedJob& job, const JobBody& body, const LayerRange& range) {
    const double cell_mm = job.options.prediction.cell_mm, share = double(range.layers()) / body.grid.size[2];
    Amounts amounts{};
    amounts.area_mm2 = coloured_area_mm2(*body.surface);
    amounts.cells = amounts.area_mm2 / (cell_mm * cell_mm);
    amounts.voxels = share * double(body.grid.voxels());
    amounts.shell_voxels = share * std::min(double(body.grid.voxels()),
                                            amounts.area_mm2 * job.options.shell_mm() / body.grid.voxel_volume_mm3());
    return amounts;
}

class Phases {
public:
    explicit Phases(std::size_t threads) : threads_(threads) {}

    void add(Phase phase, double cpu_s, double bytes) {
        phases_.push_back(
            {phase, cpu_s, seconds_on_threads(cpu_s, threads_), static_cast<std::uint64_t>(bytes), false});
    }
    [[nodiscard]] std::vector<PhaseEstimate> take() { return std::move(phases_); }

private:
    std::size_t threads_;
    std::vector<PhaseEstimate> phases_;
};

double prediction_cost(const OpenedJob& job, const JobBody& body, PredictionModel model, double area_mm2) {
    ModelOptions quality;
    quality.cell_mm = job.options.prediction.cell_mm;
    quality.viewing_cells = !optics::voxels_are_apart(job.resins.set);
    const std::array pitch_mm{body.grid.pitch_mm.x(), body.grid.pitch_mm.y(), body.grid.pitch_mm.z()};
    return prediction_seconds(model, quality, pitch_mm, area_mm2, job.resins.set.channels.size());
}

}  // namespace

double seconds_on_threads(double cpu_s, std::size_t threads) {
    return cpu_s * (serial + (1 - serial) / double(std::max<std::size_t>(threads, 1)));
}

std::vector<PhaseEstimate> phase_estimates(const OpenedJob& job, const JobBody& body, const PlannedWork& work,
                                           std::size_t threads, std::uint64_t resident_bytes) {
    const ResolvedJob& options = job.options;
    const Amounts amounts = amounts_of(job, body, work.layers);
    const double working = double(resident_bytes) + work_bytes + bytes_per_thread * double(threads);
    const auto with = [&](double bytes, double bytes_per_cell) {
        return working + bytes + bytes_per_cell * amounts.cells;
    };
    const LoopPlan& loop = work.loop;
    const LoopCost cost =
        expected_cost(loop, amounts.area_mm2, options.prediction.cell_mm, options.prediction.memory_bytes);
    double looping = !loop.wanted   ? working
                     : loop.descent ? with(descent_bytes, descent_bytes_per_cell)
                                    : with(feedback_bytes, feedback_bytes_per_cell);
    if (loop.wanted && cost.most_bytes > 0) looping = std::min(looping, cost.most_bytes);
    Phases phases(threads);
    if (job.other)
        for (const OtherPrint::Work& of : job.other->work(job.resins)) phases.add(of.phase, of.cpu_s, working);
    else
        phases.add(Phase::separate, separation_s, working);
    if (loop.wanted) {
        phases.add(Phase::prepare_loop, recipes_s + preparation_s_per_cell * amounts.cells,
                   with(0, prepared_bytes_per_cell));
        const double of_rgb = double(job.resins.set.channels.size()) / 3;  // light is followed channel by channel
        phases.add(Phase::loop, of_rgb * cost.cpu_seconds, looping);
    }
    phases.add(Phase::layers,
               layers_s + layers_s_per_voxel * amounts.voxels + layers_s_per_shell_voxel * amounts.shell_voxels,
               looping + topmost_bytes_per_column * double(body.grid.size[0]) * double(body.grid.size[1]));
    const bool predicts = work.prediction.by == PredictionPlan::By::model;
    const bool knows_white = loop.wanted && work.prediction.model == PredictionModel::transport &&
                             options.loop.model == PredictionModel::transport;
    if (predicts)
        phases.add(Phase::predict,
                   (knows_white ? without_white : 1) * predicted_cpu *
                       prediction_cost(job, body, work.prediction.model, amounts.area_mm2),
                   working + prediction_bytes(amounts.cells) +
                       (loop.wanted ? kept_bytes + kept_bytes_per_cell * amounts.cells : 0));
    const double drawn_s = predicts || loop.wanted ? seen_s_per_cell : drawn_s_per_cell;
    if (options.report)
        phases.add(Phase::report, report_s + drawn_s * amounts.cells,
                   std::max(looping, predicts ? with(drawn_bytes, drawn_bytes_per_cell) : working));
    return phases.take();
}

std::vector<ExpectedStage> expected_stages(const std::vector<PhaseEstimate>& phases) {
    std::vector<ExpectedStage> stages;
    for (const PhaseEstimate& phase : phases) stages.push_back({std::string(name_of(phase.phase)), phase.seconds});
    return stages;
}

std::vector<ExpectedStage> expected_stages(const std::vector<PhaseEstimate>& phases,
                                           std::initializer_list<Phase> those) {
    std::vector<PhaseEstimate> chosen;
    std::ranges::copy_if(phases, std::back_inserter(chosen), [&](const PhaseEstimate& phase) {
        return std::find(those.begin(), those.end(), phase.phase) != those.end();
    });
    return expected_stages(chosen);
}

double most_bytes_of_surface(double area_mm2, double cell_mm) {
    const double cells = area_mm2 / (cell_mm * cell_mm);
    // A model predicts while the mixtures of the loop are kept.
    return std::max(prediction_bytes(cells) + kept_bytes + kept_bytes_per_cell * cells,
                    descent_bytes + descent_bytes_per_cell * cells);
}

std::uint64_t bytes_of_voxels(const OpenedJob& job, const JobBody& body, const LayerRange& range) {
    constexpr double blocks_of_shell = 3;  // a byte for each voxel of the blocks that it reaches into (layer_volume.h)
    const Amounts amounts = amounts_of(job, body, range);
    return static_cast<std::uint64_t>(std::min(amounts.voxels, blocks_of_shell * amounts.shell_voxels));
}

std::uint64_t disk_bytes_of_copy(const OpenedJob& job, const JobBody& body, const LayerRange& range) {
    return layer_bytes(body.grid, {coloured_area_mm2(*body.surface), job.options.shell_mm(), range.layers(),
                                   job.outputs(), job.resins.entries.size()});
}

std::uint64_t disk_bytes(const OpenedJob& job, const JobBody& body, const LayerRange& range, const LoopPlan& loop) {
    constexpr double page_bytes = 6e6, bytes_per_cell = 50;  // pictures, and meshes of what will be seen
    const ResolvedJob& options = job.options;
    const double area_mm2 = coloured_area_mm2(*body.surface), cell_mm = options.prediction.cell_mm;
    const std::uint64_t layers = disk_bytes_of_copy(job, body, range);
    const double report = options.report ? page_bytes + bytes_per_cell * area_mm2 / (cell_mm * cell_mm) : 0;
    // What the loop puts there is gone before the layers come.
    const double looping =
        loop.wanted ? expected_cost(loop, area_mm2, cell_mm, options.prediction.memory_bytes).disk_bytes : 0;
    return std::max(layers + static_cast<std::uint64_t>(report), static_cast<std::uint64_t>(looping));
}

}  // namespace voxtone::slicer
