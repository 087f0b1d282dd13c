// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate edge samples`: what an edge measurement needs that is not bought: the slabs of every resin, as a
// stack for a printer, and the sheet with its edges, as a drawing that is exact in mm.
//
// Slabs lie flat, side by side, one row a thickness, each thicker by what polishing takes off. The sheet (SVG, A4): a
// checkerboard of 20 mm squares, which gives edges and pixels per mm, four fiducials (ArUco, DICT_5X5_1000, 0 to 3 from
// the upper left, clockwise) and a line of 100 mm to see whether it was printed at its size.
#pragma once

#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/target/target_job.h"

namespace voxtone::calibration {

struct EdgeSamplesJob {
    std::vector<std::string> roles;            ///< of the resins
    std::vector<double> thickness_mm{0.5, 1};  ///< after polishing
    double allowance_mm = 0;                   ///< printed more on each slab's thickness
    double edge_mm = 40, gap_mm = 4;           ///< of a slab; between slabs
    std::string out;                           ///< folder of the stack, for edge-sheet.svg

    /// Throws UsageError, InputError that names the option and the rule.
    void validate() const;
};

/// Every slab, and the size of all.
struct EdgeSlabs {
    std::vector<TargetBox> boxes;
    Eigen::Vector3d size_mm = Eigen::Vector3d::Zero();
};
[[nodiscard]] EdgeSlabs edge_slabs(const EdgeSamplesJob& job);

/// The sheet as an SVG file.
[[nodiscard]] std::string edge_sheet_svg();

[[nodiscard]] JobResult run_edge_samples_job(const EdgeSamplesJob& job, const PrintBoxes& print, Progress& progress);

}  // namespace voxtone::calibration
