// SPDX-License-Identifier: GPL-3.0-or-later
//
// One job from a model or a picture to a finished, printable stack in its output folder.
#pragma once

#include <string>

#include "base/error.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

struct SliceResult {
    std::string json;     ///< report.json: one JSON object
    std::string summary;  ///< a few lines for a person
    /// Of a whole stack: with `strict`, check_failed where it will not look as asked.
    ExitCode exit_code = ExitCode::done;
};

/// Runs the job. Throws Error (with its exit code): the output folder holds then what it held before, or the whole new
/// stack without its report.
SliceResult run_slice_job(const SliceOptions& options, Progress& progress);

}  // namespace voxtone::slicer
