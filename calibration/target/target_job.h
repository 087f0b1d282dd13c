// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate target` and `calibrate chart`: a target laid out, printed, described (target_file.h) and drawn.
// How boxes become layers of a printer is not known here: the caller brings it.
//
// A chart's mixtures are chosen by calibration/chart/chart_mixtures.h and shuffled, so that colour and place have
// nothing to do with each other: light that falls off does no harm, and a chart that was measured turned or mirrored
// makes no sense. chart.csv is its form, a line a patch in measuring order, for the instrument's L, a, b.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/target/target_layout.h"
#include "io/layers/manifest.h"

namespace voxtone::calibration {

struct TargetJob {
    TargetOptions layout;                    ///< for the printer's voxels; without a chart's mixtures and surfaces
    std::vector<std::string> surfaces = {};  ///< as parse_target_surface (target_surfaces.h) takes them
    std::size_t patches = 0;                 ///< of a chart; 0: a target
    bool strips = false;                     ///< of checkers besides, of the three pairs that tell most
    std::size_t thin = 0;                    ///< mixtures of the target that validates a fit; 0: the layout's
    std::string resin_set;  ///< the resins as far as they are known, or a file of them; empty: nothing is known
    std::vector<std::array<std::uint8_t, 3>>
        display_rgb;  ///< sRGB of `layout.roles`, for the picture; contract: as many
    std::string out;  ///< folder of the stack, for target.json and target.png

    /// Throws UsageError that names what is missing; what is wrong with the layout lay_out_target says.
    void validate() const;
};

/// Boxes from (0, 0, 0) to `size_mm` as a printed stack in the job's folder.
using PrintBoxes = std::function<io::StackDescription(const std::vector<TargetBox>& boxes,
                                                      const Eigen::Vector3d& size_mm, Progress& progress)>;

/// Throws Error (with its exit code). Warns of a base that light may come through.
[[nodiscard]] JobResult run_target_job(const TargetJob& job, const PrintBoxes& print, Progress& progress);

}  // namespace voxtone::calibration
