// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of a chart's fit: what it is worth on mixtures that it has not seen, how many channels it took and why,
// where it must not be trusted, what the channels are; below, the patches measured beside predicted (patch_page.h). Of
// laminates figures and resins alone.
#pragma once

#include <string>

#include "calibration/chart/chart_fit.h"
#include "calibration/fit/patch_map.h"
#include "calibration/patches/patch_check.h"

namespace voxtone::calibration {

/// `check`: of the fit's set with `table`, the patches that are shown.
[[nodiscard]] std::string chart_fit_html(const ChartFit& fit, const PatchTable& table, const PatchCheck& check,
                                         const PatchMap& map);

}  // namespace voxtone::calibration
