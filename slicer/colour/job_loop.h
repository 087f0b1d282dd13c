// SPDX-License-Identifier: GPL-3.0-or-later
//
// The appearance loop of a job: from the open-loop print to the mixtures of its surface cells that look most like the
// target.
//
// Whether there is one says part/loop_plan.h.
//
// First everything is prepared that may refuse the job (LoopCells, LoopProblem, the checkpoint of an interrupted job);
// then the loop runs, for hours if need be.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "halftone/loop/appearance_loop.h"
#include "halftone/loop/minimal_depth_separation.h"
#include "slicer/colour/print_parts.h"
#include "slicer/colour/viewed_cells.h"
#include "slicer/layers/cell_index.h"
#include "slicer/layers/skin_source.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/part/loop_plan.h"
#include "slicer/part/skin_file.h"

namespace voxtone::slicer {

/// Where the unknowns of the loop lie: the cells of the surface, the layers below them, and the way there from a voxel.
/// What the loop finds refers to it. Stays where it was made.
struct LoopCells {
    /// `colour_mm`: depth of the print's coloured shell.
    LoopCells(ViewedCells cells, const JobBody& body, const DepthZones& zones, double colour_mm);
    LoopCells(const LoopCells&) = delete;
    LoopCells& operator=(const LoopCells&) = delete;

    const ViewedCells seen;
    const DepthZones zones;
    const halftone::SkinLayers layers;
    const SurfacePlaces places;
    const CellIndex index;
    const std::vector<char> apart;  ///< a picture's back and rim, where labels lie
    [[nodiscard]] SkinMap map() const { return {places, index, layers, zones, apart}; }
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
    const int white;                  ///< index of the resin of which that is
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
    std::vector<halftone::CumulativeMixture> mixtures;  ///< as SkinSource takes them; empty: the open loop was best
    bool reread = false;                                ///< from a skin file: the cells have no faces
};

/// What shards and other jobs of the body need of it, and the way back. `colour_mm`: depth of the coloured shell.
[[nodiscard]] SavedSkin saved_skin(const JobLoop& loop);
[[nodiscard]] JobLoop loop_of(SavedSkin skin, const JobBody& body, const DepthZones& zones, double colour_mm);

/// Goes on after `before` where there is one. Writes the checkpoint after each iteration, or where that takes longer
/// than anybody would notice as often as a sixtieth of the time allows; where it cannot be written the loop goes on,
/// with a warning; says how to go on to who stops it (set_stop_advice). Throws ResourceError, Cancelled.
[[nodiscard]] JobLoop run_job_loop(const LoopProblem& problem, const LoopPlan& plan, const LoopCheckpoint& checkpoint,
                                   std::optional<halftone::ResumedLoop> before, Progress& progress);

}  // namespace voxtone::slicer
