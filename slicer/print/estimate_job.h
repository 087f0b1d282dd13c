// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job will take (job_estimate.h), in seconds and without an output folder: the model is read, repaired and
// placed as for the job itself, its colours are separated, and the rest is counted and sampled.
#pragma once

#include "base/progress.h"
#include "slicer/options/slice_options.h"
#include "slicer/part/job_plan.h"
#include "slicer/print/colour_mixtures.h"
#include "slicer/print/job_estimate.h"
#include "slicer/print/resin_volumes.h"

namespace voxtone::slicer {

struct EstimateScope {
    bool orientations = false;  ///< and the table of them
    bool resins = true;         ///< how much of each; without that colours need not be separated
    bool of_a_tray = false;     ///< a part, which may be lower than a print
};

/// `asked.out` may be empty; nothing is written. Throws as the job would for all that is wrong with options, printer,
/// resins and model, and Cancelled.
[[nodiscard]] JobEstimate estimate_job(const SliceOptions& requested, Progress& progress,
                                       const EstimateScope& scope = {});

struct MeasuredBody {
    JobBody body;
    PhaseEstimate read;  ///< what that has taken
};
/// The body of a job. Throws what reading it throws.
[[nodiscard]] MeasuredBody read_measured(const OpenedJob& job, Progress& progress);

/// estimate_job of a body that is known; its job gets the resins that suit it best.
[[nodiscard]] JobEstimate estimate_body(const OpenedJob& opened, const JobBody& body, const PhaseEstimate& read,
                                        const EstimateScope& scope, Progress& progress);

/// What so much of its resins weighs and costs.
void add_amounts(const OpenedJob& job, const ResinVolumes& volumes, JobEstimate& estimate);

/// A job as far as it is planned.
struct PlannedPrint {
    const OpenedJob& job;
    const JobBody& body;
    const JobPlan& plan;
};

/// `read`: what reading the body has taken. `made_with`: of a colour print; null: its resins are not known.
[[nodiscard]] JobEstimate estimate_print(const PlannedPrint& planned, const PhaseEstimate& read,
                                         const ColourRecipes* made_with, const Progress& progress);

}  // namespace voxtone::slicer
