// SPDX-License-Identifier: GPL-3.0-or-later
//
// A fit to look at, as one HTML page that needs nothing else: every patch measured beside predicted (patch_page.h),
// what each Principle sees (Iser, Rittig, Wilkie 2025, Figs. 6 to 8, for the resins and the patches at hand), every
// resin's values over the channels with their errors and doubts.
#pragma once

#include <string>

#include "calibration/fit/patch_map.h"
#include "calibration/fit/resin_fit.h"

namespace voxtone::calibration {

[[nodiscard]] std::string fit_report_html(const ResinFit& fit, const PatchTable& table, const FitOptions& options,
                                          const PatchMap& map);

}  // namespace voxtone::calibration
