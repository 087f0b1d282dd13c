// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate check`: how well a set of resins predicts measured patches (calibration/patches/patch_check.h).
#pragma once

#include <string>

#include "base/job_result.h"
#include "calibration/fit/patch_map.h"
#include "calibration/patches/measured_patches.h"

namespace voxtone::calibration {

struct CheckJob {
    std::string resins;   ///< set or file
    std::string patches;  ///< file (calibration/patches/patch_file.h)
    MeasuredPatchOptions measured;
    PatchModelOptions model;  ///< g and eta are the set's
    std::string page;         ///< to look at (patch_page.h); empty: none
    PatchMapFiles map;        ///< of the page
    bool overwrite = false;   ///< a page that is there is replaced
};

/// Throws Error (with its exit code); nothing is written then.
[[nodiscard]] JobResult run_check_job(const CheckJob& job, Progress& progress);

}  // namespace voxtone::calibration
