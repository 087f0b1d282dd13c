// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stack as a picture that a camera would take of its print.
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/proof/proof_options.h"

namespace voxtone::slicer {

/// Throws Error (with its exit code). Asked to stop, it writes what there is, says so in the files and ends with
/// ExitCode::unfinished; where there is nothing yet it throws Cancelled.
JobResult run_proof_job(const ProofOptions& options, Progress& progress);

}  // namespace voxtone::slicer
