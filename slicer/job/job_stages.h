// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stages that a job will go through and about how long each takes, for the time that is shown as left. The guesses
// need to be right to a factor of two or three: what the first stages really take corrects the others
// (base/job_outlook.h).
#pragma once

#include <vector>

#include "voxtone/base/job_outlook.h"
#include "voxtone/slicer/job/opened_job.h"

namespace voxtone::slicer {

/// From the moment at which the body is known.
[[nodiscard]] std::vector<ExpectedStage> expected_stages(const OpenedJob& job, const JobBody& body,
                                                         const LayerRange& range);

}  // namespace voxtone::slicer
