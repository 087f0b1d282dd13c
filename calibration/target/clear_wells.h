// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a camera reads of deep squares of clear resin among light resin, by light paths (optics/monte_carlo): light runs
// sideways in them as far as they are deep and meets walls, in which it goes millimetres far. In Vero white a square of
// 5 mm is 0.029 +- 0.002 darker in red than without end, one of 10 mm 0.015; in green and blue 0.005 at most
// (benchmarks/calibration/target/square_tracer, 100,000 paths; clear of 0.004, 0.006, 0.02 mm^-1).
//
// One square at a time in light resin that has mirrors 8 mm away; light from 45 degrees all around, as several
// photographs of a turned target have it. The same paths for the same resins; 20,000 have a standard error of 0.005.
#pragma once

#include <vector>

#include "calibration/target/target_layout.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

/// rho(45 -> 0) of the middle of a deep square, `sampled` of its edge, by channel; the base ends in air. `set`: its
/// light and clear resin.
[[nodiscard]] std::vector<double> light_of_well(const TargetSquare& well, double under_mm, const optics::ResinSet& set,
                                                double sampled, double paths);
/// The same without walls.
[[nodiscard]] std::vector<double> well_without_end(const TargetSquare& well, double under_mm,
                                                   const optics::ResinSet& set);

}  // namespace voxtone::calibration
