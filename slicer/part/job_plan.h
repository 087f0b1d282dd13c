// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job will do, decided once from what was asked for and the body: the layers that are made, whether there is a
// loop and of which kind, who predicts, and what each phase takes. `slice`, `--shard`, `merge` and `estimate`, and
// through its estimate a batch and a cluster, go by it; nothing decides any of that again.
//
// But for times, memory and disk it depends on the job and its body alone, and so does every bit that is printed: where
// a machine lacks what the plan takes, the job says so and stops.
#pragma once

#include <cstdint>
#include <vector>

#include "slicer/options/option_values.h"
#include "slicer/part/loop_plan.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/phase.h"
#include "slicer/part/prediction_plan.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

struct JobPlan {
    VoxelGrid grid;                     ///< of the print; the body is its one part, at its corner
    LayerRange layers;                  ///< of the print, that are made
    bool all_layers = true;             ///< that it has
    bool all_white = false;             ///< white is asked for everywhere, and printed
    LoopPlan loop;                      ///< none of a print without colours
    PredictionPlan prediction;          ///< where the loop, if one is planned, comes to its end
    std::vector<PhaseEstimate> phases;  ///< from the moment at which the body is known, on this machine
    std::uint64_t disk_bytes = 0;       ///< most that the stack and its report take
};

/// Of a job whose resins are loaded (part/resin_choice.h). Throws InputError for layers that the body has not.
[[nodiscard]] JobPlan plan_job(const OpenedJob& job, const JobBody& body);

/// Who predicts once it is known whether the loop came to something that can be shown.
[[nodiscard]] PredictionPlan plan_prediction(const OpenedJob& job, const JobBody& body, const JobPlan& plan,
                                             bool looped);

}  // namespace voxtone::slicer
