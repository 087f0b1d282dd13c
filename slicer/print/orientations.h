// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ways in which a body can be turned by right angles, and what each would mean for its print. Of the 24 those are
// left out that repeat another: half a turn about the upright, and a quarter one where the body is as wide as deep.
//
// A printer that jets its material supports whatever hangs over: surfaces that lie on support come out matte, and what
// is under them is filled. Faces that lie downward are those whose normal is within 45 degrees of straight down.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "slicer/part/opened_job.h"
#include "slicer/print/job_estimate.h"

namespace voxtone::slicer {

/// The best first: those that fit; with the least coloured surface downward, to 1 % of the surface; the lowest; with
/// the least air below.
[[nodiscard]] std::vector<Orientation> orientations(const OpenedJob& job, const JobBody& body,
                                                    const Progress& progress);

/// The first of them, against the job's own. Nothing where it does not fit.
[[nodiscard]] std::optional<OrientationAdvice> advised_orientation(std::span<const Orientation> best_first,
                                                                   double surface_mm2);

}  // namespace voxtone::slicer
