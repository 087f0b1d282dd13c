// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate edge photo`: from the photographs of a bench (bench_list.h) to the profiles that `edge fit` reads,
// with a picture of what was measured in each, and what setup.json should say of sheet and camera.
#pragma once

#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/bench/slab_reading.h"

namespace voxtone::calibration {

struct BenchPhotoJob {
    std::string list;                        ///< photographs.csv
    std::string setup;                       ///< setup.json; empty: the defaults
    std::string checker = "colorchecker24";  ///< chart, or its file
    BenchLightOptions light;                 ///< its width does not count
    double square_mm = 20;                   ///< of the checkerboard
    double length_mm = 10;                   ///< along the edge; across it: the setup's
    std::string out;                         ///< profiles.csv
    std::string overlays;                    ///< folder of the pictures; empty: beside the profiles, NAME-overlays
    std::string new_setup;                   ///< setup.json with what was measured; empty: none
    bool overwrite = false;

    /// Throws UsageError, InputError that names the option and the rule.
    void validate() const;
};

/// What was measured, without files.
struct BenchReading {
    std::vector<EdgeProfile> profiles;
    SheetReading sheet;
    SheetBase base;
    EdgeSetup setup;  ///< the given one with the sheet, pitch, blur and level error that were measured
    std::vector<std::string> warnings;
};

[[nodiscard]] JobResult run_bench_photo_job(const BenchPhotoJob& job, Progress& progress);

}  // namespace voxtone::calibration
