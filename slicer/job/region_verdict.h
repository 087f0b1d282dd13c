// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is said of the solids, the type and the paper of a print, each as the one thing that a person sees
// (halftone/loop/colour_regions.h). A region is good where the CIEDE2000 of its means and its unevenness are not above
// the verdict's "bad", and where type and lines, if they were asked for with a contrast of a half or more, have that:
// ISO 9241-303 asks for as much of characters. Contrast is (a - b) / (a + b) of the luminances of strokes and of what
// lies within 0.5 mm of them. Type whose strokes are not wider than a cell is no region: where three tenths of
// the surface are regions, and the target has a fine contrast of 0.08 and more in Oklab's lightness of which not 0.6
// is left (halftone/loop/lost_contrast.h), over a quarter of a square millimetre, that is said of the place where most
// is lost. The figures were chosen on the small print of public bug reports, which nobody can read, and on type of 4 to
// 14 points.
#pragma once

#include <string>
#include <vector>

#include "voxtone/io/report/report.h"
#include "voxtone/slicer/job/job_prediction.h"
#include "voxtone/slicer/options/resolved_job.h"
#include "voxtone/slicer/prepare/job_colour.h"

namespace voxtone::slicer {

/// "orange", from linear sRGB.
[[nodiscard]] std::string colour_word(const Eigen::Vector3f& rgb);

/// All regions, the worst first. Empty where nothing is flat, as in photographs.
[[nodiscard]] std::vector<io::ReportRegion> judge_regions(const JobPrediction& prediction, const JobColour& colour,
                                                          const VerdictLimits& limits);

}  // namespace voxtone::slicer
