// SPDX-License-Identifier: GPL-3.0-or-later
//
// How charts of mixtures are fitted: what `calibrate fit` and `calibrate icc` have alike.
#pragma once

#include <string>

#include "calibration/fit/fit_job.h"
#include "cli/program/common_options.h"

namespace voxtone::cli {

/// Words that the fit of a chart is made of.
struct ChartOptions {
    std::string channels = "auto", geometry = "45/0";
    bool no_residual = false;
};

/// --channels, --no-residual, --lengths-from, --geometry.
void add_chart_options(Verb& command, ChartOptions& options, calibration::FitJob& job);

/// Throws UsageError.
void set_chart_fit(const ChartOptions& options, calibration::ChartFitOptions& chart);

}  // namespace voxtone::cli
