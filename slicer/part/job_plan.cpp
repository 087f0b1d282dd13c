// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/job_plan.h"

#include "base/parallel.h"
#include "base/process_usage.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

PredictionPlan plan_prediction(const OpenedJob& job, const JobBody& body, const JobPlan& plan, bool looped) {
    // A spectral set is asked for its spectra, which the loop does not keep.
    const bool reusable = looped && !job.resins.set.channels.is_spectral();
    return plan_prediction(job, body, plan.all_layers, reusable, plan.all_white);
}

JobPlan plan_job(const OpenedJob& job, const JobBody& body) {
    JobPlan plan;
    plan.grid = body.grid;
    plan.layers = range_within(job.options.layers, plan.grid.size[2]);
    plan.all_layers = plan.layers.layers() == plan.grid.size[2];
    if (!job.other) {
        plan.all_white = prints_all_white(SurfaceColour(body.model.mesh, job.options.prediction.cell_mm), job.resins);
        plan.loop = plan_loop(job, body, plan.all_white);
        plan.prediction = plan_prediction(job, body, plan, plan.loop.wanted);
        plan.loop.last_look = plan.prediction.last_look;
    }
    plan.phases =
        phase_estimates(job, body, {plan.layers, plan.loop, plan.prediction}, thread_count(), resident_bytes());
    plan.disk_bytes = disk_bytes(job, body, plan.layers, plan.loop);
    return plan;
}

}  // namespace voxtone::slicer
