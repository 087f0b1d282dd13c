// SPDX-License-Identifier: GPL-3.0-or-later
//
// The appearance loop of a job: from the open-loop print to the mixtures of its surface cells that look most like the
// target.
//
// The loop is left out where it has nothing to choose (one resin), where it was not asked for, and, unless it was,
// where the coloured surface is larger than auto_loop_cm2; where its memory does not suffice the job goes on with the
// open loop and says so.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/halftone/loop/appearance_loop.h"
#include "voxtone/halftone/loop/surface_first.h"
#include "voxtone/slicer/job/job_body.h"
#include "voxtone/slicer/job/job_colour.h"
#include "voxtone/slicer/job/print_parts.h"
#include "voxtone/slicer/layers/cell_index.h"
#include "voxtone/slicer/layers/skin_source.h"
#include "voxtone/slicer/options/slice_options.h"

namespace voxtone::slicer {

struct LoopPlan {
    int iterations = 0;   ///< most; -1: until it stops gaining; 0: no loop
    std::string why_not;  ///< where none: a sentence, or empty where none was wanted
};

/// By `options.iterations`: a number, or auto.
[[nodiscard]] LoopPlan plan_loop(const SliceOptions& options, const JobBody& body, const LoadedResins& resins);

/// What came out, and all that its mixtures refer to. Stays where it was made.
class JobLoop {
public:
    JobLoop(const SliceOptions& options, const LoopPlan& plan, const JobBody& body, const LoadedResins& resins,
            const JobColour& colour, const PrintParts& parts, const std::filesystem::path& folder, Progress& progress);
    JobLoop(const JobLoop&) = delete;
    JobLoop& operator=(const JobLoop&) = delete;

    /// Null: the open loop was best.
    [[nodiscard]] const SkinSource* skin() const { return skin_ ? &*skin_ : nullptr; }

    std::string model;
    optics::Surface surface;
    std::vector<Eigen::Vector3f> target;  ///< as asked for, per cell
    std::array<double, 3> cell_um{};
    halftone::LoopResult result;
    double seconds = 0;

private:
    halftone::SkinLayers layers_;
    SurfacePlaces places_;
    std::optional<CellIndex> cells_;
    std::unique_ptr<const halftone::SurfaceFirst> recipes_;
    std::optional<SkinSource> skin_;
};

}  // namespace voxtone::slicer
