// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a plan will take, before any of its jobs is begun: a line a job, and what they add up to.
#pragma once

#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "farm/batch/plan.h"
#include "slicer/print/estimate_job.h"

namespace voxtone::farm {

struct PlannedEstimate {
    std::string job, model;
    slicer::JobEstimate estimate;
    std::string fault;  ///< why it cannot be estimated, and so not be sliced; empty: it can
    int exit_code = 0;  ///< of the fault
};

/// Each job as estimate_job has it, one after the other. Exit code 0; where some cannot be estimated, that of the
/// first. Throws what reading the plan throws, TryAgain, Cancelled.
[[nodiscard]] JobResult run_plan_estimate(const PlanOptions& plan, const slicer::EstimateScope& scope,
                                          Progress& progress);

/// data/schema/plan-estimate.schema.json
[[nodiscard]] std::string plan_estimate_json(const std::vector<PlannedEstimate>& jobs);
[[nodiscard]] std::string plan_estimate_text(const std::vector<PlannedEstimate>& jobs);

}  // namespace voxtone::farm
