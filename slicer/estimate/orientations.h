// SPDX-License-Identifier: GPL-3.0-or-later
//
// The 24 ways in which a body can be turned by right angles, and what each would mean for its print.
//
// A printer that jets its material supports whatever hangs over: surfaces that lie on support come out matte, and what
// is under them is filled. Faces that lie downward are those whose normal is within 45 degrees of straight down.
#pragma once

#include <vector>

#include "base/progress.h"
#include "slicer/estimate/job_estimate.h"
#include "slicer/prepare/opened_job.h"

namespace voxtone::slicer {

/// As the job turns it first, then those with the least coloured surface downward, of these the lowest.
[[nodiscard]] std::vector<Orientation> orientations(const OpenedJob& job, const JobBody& body,
                                                    const Progress& progress);

}  // namespace voxtone::slicer
