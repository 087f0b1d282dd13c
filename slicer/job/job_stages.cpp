// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/job_stages.h"

#include <array>

#include "voxtone/slicer/job/job_loop.h"
#include "voxtone/slicer/job/job_prediction.h"
#include "voxtone/slicer/look/prediction_time.h"
#include "voxtone/slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

// Seconds on two cores of 2.5 GHz, by `voxtone slice` of photographs 5 to 15 mm wide and of the bundled cow at 15 and
// 30 mm (stages of report.json).
constexpr double separation_s = 1.5, report_s = 1;
constexpr double preparation_s_per_cell = 6e-6;
constexpr double layers_s_per_voxel = 1e-8, layers_s_per_shell_voxel = 1e-7;
constexpr double profiles_s_per_resin = 1, search_s_per_cluster = 1, traced_search_s_per_cluster = 5;

double layers_seconds(const OpenedJob& job, const JobBody& body, const LayerRange& range, double area_mm2) {
    const double layer_voxels = double(body.grid.size[0]) * body.grid.size[1];
    const double shell_voxels = area_mm2 * job.options.colour.depth_mm / body.grid.pitch_mm.prod();
    const double share = double(range.layers()) / body.grid.size[2];
    return share * (layers_s_per_voxel * layer_voxels * body.grid.size[2] + layers_s_per_shell_voxel * shell_voxels);
}

void expect_layered(const OpenedJob& job, std::vector<ExpectedStage>& stages) {
    const bool traced = job.options.layered->rounds.value_or(1) > 0 && job.options.layered->materials.empty();
    stages.push_back({"profiles of the resins", profiles_s_per_resin * double(job.resins.set.resins.size())});
    stages.push_back({"search stacks",
                      (traced ? traced_search_s_per_cluster : search_s_per_cluster) * double(job.map->target.size())});
}

}  // namespace

std::vector<ExpectedStage> expected_stages(const OpenedJob& job, const JobBody& body, const LayerRange& range) {
    const ResolvedJob& options = job.options;
    const double area_mm2 = coloured_area_mm2(*body.surface);
    const double cells = area_mm2 / (options.prediction.cell_mm * options.prediction.cell_mm);
    const LoopPlan loop = options.layered ? LoopPlan{} : plan_loop(options, body, job.resins);
    std::vector<ExpectedStage> stages;
    if (options.layered)
        expect_layered(job, stages);
    else
        stages.push_back({"separate colours", separation_s});
    if (loop.wanted) {
        stages.push_back({"prepare the loop", separation_s + preparation_s_per_cell * cells});
        stages.push_back({"appearance loop", expected_cost(loop, area_mm2, options.prediction.cell_mm).seconds});
    }
    stages.push_back({"layers", layers_seconds(job, body, range, area_mm2)});
    const bool all_layers = range.layers() == body.grid.size[2];
    const PredictionPlan prediction =
        options.layered ? PredictionPlan{} : plan_prediction(options, body, all_layers, loop.wanted);
    if (prediction.by == PredictionPlan::By::model) {
        ModelOptions quality;
        quality.cell_mm = options.prediction.cell_mm;
        const std::array pitch_mm{body.grid.pitch_mm.x(), body.grid.pitch_mm.y(), body.grid.pitch_mm.z()};
        stages.push_back({"predict", prediction_seconds(prediction.model, quality, pitch_mm, area_mm2)});
    }
    stages.push_back({"report", report_s});
    return stages;
}

}  // namespace voxtone::slicer
