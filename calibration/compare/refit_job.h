// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate fit PRINT-REGIONS... --prior SET`: photographed prints make the set better by which they were
// predicted (refit.h).
#pragma once

#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"

namespace voxtone::calibration {

struct RefitJob {
    std::vector<std::string> sheets;  ///< of `compare --refit`
    std::string prior;                ///< set or file; empty: by which the first print was predicted
    std::string name;                 ///< of the set; empty: that of the file `out`
    std::string out;                  ///< resin set; what moved goes beside it, as NAME.fit.json
    bool overwrite = false;
};

/// Throws Error (with its exit code); nothing is written then, unless it is the disk that fails.
[[nodiscard]] JobResult run_refit_job(const RefitJob& job, Progress& progress);

}  // namespace voxtone::calibration
