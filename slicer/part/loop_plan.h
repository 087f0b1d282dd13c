// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a job has an appearance loop, of which kind, and what that takes, known before its colours are separated.
//
// The loop is left out where it has nothing to choose (one resin) and where it is not wanted (--iterations 0). Where
// its memory would surely not suffice it is wanted all the same, and the job stops: what is printed is the same on
// every machine.
#pragma once

#include <cstdint>
#include <string>

#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/part/opened_job.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

struct LoopPlan {
    bool wanted = false;
    int iterations = -1;       ///< most; -1: until it stops gaining
    bool patient = false;      ///< it may go on for long while it gains
    bool descent = true;       ///< after feedback
    bool last_look = false;    ///< its last prediction is the job's (prediction_plan.h)
    std::string why_not;       ///< where it is not wanted: a sentence, or empty where none is due
    std::string does_not_fit;  ///< where it would surely take more memory than is allowed: a sentence
};

/// Of a job that resumes: with no iterations too, what an interrupted loop has found is looked at.
/// `all_white`: white is asked for everywhere and printed: nothing is rearranged without being asked.
[[nodiscard]] LoopPlan plan_loop(const OpenedJob& job, const JobBody& body, bool all_white);

/// Of a print whose core is the white resin.
[[nodiscard]] bool prints_all_white(const SurfaceColour& target, const LoadedResins& resins);

/// Why no loop could change anything: a sentence; empty where one could.
[[nodiscard]] std::string nothing_to_rearrange(const JobBody& body, const LoadedResins& resins);

/// Of what is allowed, what is left for predictions beside the print, the surface and the state of the loop; where that
/// is little they put what they do not work at on disk, and where nothing is left they try with a third. 0: no limit.
[[nodiscard]] std::uint64_t bytes_for_predictions(std::uint64_t allowed_bytes, std::size_t surface_cells);

/// What a loop takes, about: measured on cores of 2.5 GHz (docs/estimate.md), to a factor of 1.5. Its memory:
/// phase_estimates.h.
struct LoopCost {
    int iterations = 0;      ///< that are made, of a loop that stops when it gains no more
    double cpu_seconds = 0;  ///< of processors
    double most_bytes = 0;   ///< that it keeps to, of those allowed; 0: no limit
    double disk_bytes = 0;   ///< while it runs, where it keeps to them
};
/// `allowed_bytes`: where they are few what waits lies on disk; 0: no limit.
[[nodiscard]] LoopCost expected_cost(const LoopPlan& plan, double area_mm2, double cell_mm,
                                     std::uint64_t allowed_bytes);

}  // namespace voxtone::slicer
