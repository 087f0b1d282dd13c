// SPDX-License-Identifier: GPL-3.0-or-later
//
// The appearance loop of a job that was done before, for the part that is that job: what it came to is copied to where
// the part keeps its own, and is not run again.
#pragma once

#include <string>

#include "base/progress.h"
#include "slicer/plate/prepared_job.h"

namespace voxtone::slicer {

/// Why the folder of a job has no loop for this one, by what is known before the model is read; empty: it has.
[[nodiscard]] std::string why_no_kept_loop(const std::string& folder, const OpenedJob& job, const Progress& progress);

/// Looks into the folder of the job, and says why its loop is run again where it is not this part's: by what is known
/// before the model is read. Whether it was copied. Throws FileError.
bool take_kept_loop(const std::string& name, const std::string& folder, const OpenedJob& job, Progress& progress);

/// The same with what the model tells: false, and said, where it is another job's after all.
bool is_loop_of(const std::string& name, const PreparedJob& ready, Progress& progress);

}  // namespace voxtone::slicer
