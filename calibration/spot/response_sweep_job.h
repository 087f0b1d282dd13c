// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate responses`: photographs of a square of light swept over a surface, to a data set of its scattering
// (response_sweep.h, io/profiles/bssrdf_file.h).
#pragma once

#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/spot/response_sweep.h"

namespace voxtone::calibration {

struct ResponseSweepJob {
    std::string frames;  ///< table
    SweepExposures card;
    double card_albedo = 0.18;
    SweepGeometry geometry;
    CameraNoise noise;
    std::string out;  ///< .bssrdf
    bool overwrite = false;
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_response_sweep(const ResponseSweepJob& job, Progress& progress);

}  // namespace voxtone::calibration
