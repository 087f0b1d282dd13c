// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate icc`: from a printer's ICC profile (calibration/chart/icc_chart.h) to a file of resins, fitted as
// `calibrate fit` fits a chart of mixtures (calibration/chart/chart_fit.h).
#pragma once

#include <string>

#include "base/job_result.h"
#include "calibration/chart/icc_chart.h"
#include "calibration/fit/fit_job.h"

namespace voxtone::calibration {

struct IccJob {
    std::string profile;      ///< file
    IccChartOptions options;  ///< how it is read
    std::string chart;        ///< CSV to write, of the mixtures that are fitted; empty: none
    FitJob fit;               ///< of the chart; `patches` does not count

    /// Throws UsageError or InputError that names the option, its value and the rule.
    void validate() const;
};

/// Throws Error (with its exit code); nothing is written then, unless it is the disk that fails.
[[nodiscard]] JobResult run_icc_job(const IccJob& job, Progress& progress);

}  // namespace voxtone::calibration
