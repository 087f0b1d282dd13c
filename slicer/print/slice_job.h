// SPDX-License-Identifier: GPL-3.0-or-later
//
// One job from a model or a picture to a finished, printable stack in its output folder.
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// Runs the job: report.json, and of a whole stack, with `strict`, check_failed where it will not look as asked. Throws
/// Error (with its exit code): the output folder holds then what it held before, or the whole new stack without its
/// report.
JobResult run_slice_job(const SliceOptions& options, Progress& progress);

}  // namespace voxtone::slicer
