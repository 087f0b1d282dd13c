// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone compare`: photographs of a flat print, or one of a body, against what it was predicted to look like: a page,
// its figures as JSON (data/schema/compare.schema.json), and a few lines for a person.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/compare/predicted_body.h"
#include "calibration/compare/predicted_print.h"
#include "calibration/compare/print_reading.h"

namespace voxtone::calibration {

struct CompareJob {
    std::vector<std::string> photos;
    std::string stack;             ///< what was printed, for messages and the page
    std::string checker = "none";  ///< chart beside the print, or its file
    ReadPrintOptions read;         ///< its checker does not count; corners by hand are those of one photograph
    double viewing_distance_mm = 300;
    std::string out;  ///< folder
    bool overwrite = false;
    bool refit = false;  ///< regions.json is left there too, for `calibrate fit` (print_regions.h)

    /// Throws UsageError that names the option and the rule it breaks.
    void validate() const;
};

/// What OUT was predicted to look like; asked once the photographs were read.
using PredictPrint = std::function<std::variant<PredictedPrint, PredictedBody>(Progress& progress)>;

/// Throws Error (with its exit code). Warns of what is doubtful.
[[nodiscard]] JobResult run_compare_job(const CompareJob& job, const PredictPrint& predict, Progress& progress);

}  // namespace voxtone::calibration
