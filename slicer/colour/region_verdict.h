// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is said of the solids, the type and the paper of a print, each as the one thing that a person sees
// (halftone/loop/colour_regions.h). A region is good where the CIEDE2000 of its means and its unevenness are not above
// the verdict's "bad", and where type and lines, if they were asked for with a contrast of a half or more, have that:
// ISO 9241-303 asks for as much of characters. Contrast is (a - b) / (a + b) of the luminances of strokes and of what
// lies within 0.5 mm of them. Type whose strokes are not wider than a cell is no region: where three tenths of
// the surface are regions, and the target has a fine contrast of 0.08 and more in Oklab's lightness of which not 0.6
// is left (halftone/loop/lost_contrast.h), over a quarter of a square millimetre, that is said of the place where most
// is lost. A solid is not good either whose rim, the chroma of print less target within 0.6 mm of its edge, is above
// twice "bad": CIEDE2000 divides chroma by 1 + 0.045 C, by two at C = 22. The figures were chosen on the small print of
// public bug reports, which nobody can read, and on type of 4 to 14 points.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/report/report.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/options/resolved_job.h"
#include "slicer/prepare/job_colour.h"

namespace voxtone::slicer {

/// "orange", from linear sRGB.
[[nodiscard]] std::string colour_word(const Eigen::Vector3f& rgb);

/// Cells off because the body ends behind them, as one region; nothing where that is less than half a square
/// millimetre. `wall_mm`: how thick they are about, `place_mm`: where they are worst.
[[nodiscard]] std::optional<io::ReportRegion> judge_thin_walls(const JobPrediction& prediction,
                                                               std::span<const std::uint32_t> cells, double wall_mm,
                                                               const Eigen::Vector3d& place_mm,
                                                               const VerdictLimits& limits);

/// How bad a region is by what is good; above 1 it is not good.
[[nodiscard]] double badness(const io::ReportRegion& region, const VerdictLimits& limits);

/// All regions, the worst first. Empty where nothing is flat, as in photographs.
[[nodiscard]] std::vector<io::ReportRegion> judge_regions(const JobPrediction& prediction, const JobColour& colour,
                                                          const VerdictLimits& limits);

}  // namespace voxtone::slicer
