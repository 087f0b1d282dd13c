// SPDX-License-Identifier: GPL-3.0-or-later
//
// The appearance loop of a job: from the open-loop print to the mixtures of its surface cells that look most like the
// target.
//
// The loop is left out where it has nothing to choose (one resin) and where it is not wanted (--iterations 0); where
// its memory does not suffice, surely or as it turns out, the job goes on with the open loop and says so.
//
// First everything is prepared that may refuse the job (LoopCells, LoopProblem, the checkpoint of an interrupted job);
// then the loop runs, for hours if need be.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "voxtone/base/progress.h"
#include "voxtone/halftone/loop/appearance_loop.h"
#include "voxtone/halftone/loop/minimal_depth_separation.h"
#include "voxtone/slicer/job/job_body.h"
#include "voxtone/slicer/job/job_colour.h"
#include "voxtone/slicer/job/loop_checkpoint.h"
#include "voxtone/slicer/job/print_parts.h"
#include "voxtone/slicer/job/viewed_cells.h"
#include "voxtone/slicer/layers/cell_index.h"
#include "voxtone/slicer/layers/skin_source.h"
#include "voxtone/slicer/options/resolved_job.h"

namespace voxtone::slicer {

struct LoopPlan {
    bool wanted = false;
    int iterations = -1;  ///< most; -1: until it stops gaining
    bool descent = true;  ///< after feedback
    std::string why_not;  ///< where it is not wanted: a sentence, or empty where none is due
};

/// Of a job that resumes: with no iterations too, what an interrupted loop has found is looked at. Not without being
/// asked where it would surely take more memory than is allowed (expected_cost).
[[nodiscard]] LoopPlan plan_loop(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins);

/// What a loop takes, about: measured on two cores of 2.5 GHz (docs/benchmarks.md, "Bodies"), to this factor.
inline constexpr double cost_factor = 1.5;
struct LoopCost {
    int iterations = 0;  ///< that are made, of a loop that stops when it gains no more
    double seconds = 0, bytes = 0;
};
[[nodiscard]] LoopCost expected_cost(const LoopPlan& plan, double area_mm2, double cell_mm);

/// Where the unknowns of the loop lie: the cells of the surface, the layers below them, and the way there from a voxel.
/// What the loop finds refers to it. Stays where it was made.
struct LoopCells {
    /// `volume`: of the print's shape. `colour_mm`: depth of its coloured shell.
    LoopCells(ViewedCells cells, const JobBody& body, const optics::ResinVolume& volume, double colour_mm);
    LoopCells(const LoopCells&) = delete;
    LoopCells& operator=(const LoopCells&) = delete;

    const ViewedCells seen;
    const halftone::SkinLayers layers;
    const SurfacePlaces places;
    const CellIndex index;
    [[nodiscard]] SkinMap map() const { return {places, index, layers}; }
};

/// What the loop needs while it runs. Keeps references to all that it is made from. Stays where it was made.
class LoopProblem {
public:
    /// Throws ResourceError where the shape takes too much memory.
    LoopProblem(const ResolvedJob& job, const JobBody& body, const LoadedResins& resins, const JobColour& colour,
                const PrintParts& parts, const Progress& progress);
    LoopProblem(const LoopProblem&) = delete;
    LoopProblem& operator=(const LoopProblem&) = delete;

    const ResolvedJob& job;
    const LoadedResins& resins;
    const PrintParts& parts;
    const std::uint64_t print_bytes;  ///< a print as a volume may take so much
    const optics::ResinVolume shape;  ///< of one resin throughout, which takes little memory
    const optics::Scene scene;
    const std::shared_ptr<const LoopCells> cells;
    const std::unique_ptr<const halftone::MinimalDepthSeparation> recipes;
};

/// What came out.
struct JobLoop {
    std::string model;
    std::shared_ptr<const LoopCells> cells;
    halftone::LoopResult result;
    double seconds = 0;
};

/// Goes on after `before` where there is one. Writes the checkpoint after each iteration; where it cannot be written
/// the loop goes on, with a warning; says how to go on to who stops it (set_stop_advice). Throws ResourceError,
/// Cancelled.
[[nodiscard]] JobLoop run_job_loop(const LoopProblem& problem, const LoopPlan& plan, const LoopCheckpoint& checkpoint,
                                   std::optional<halftone::ResumedLoop> before, Progress& progress);

}  // namespace voxtone::slicer
