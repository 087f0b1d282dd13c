// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which mean cosine g explains patches best: a whole fit for each g from -0.9 to 0.9 in steps of 0.1 (Iser, Rittig,
// Wilkie 2025, Sec. 6.6). By similarity most values do nearly alike.
#pragma once

#include <vector>

#include "calibration/fit/resin_fit.h"

namespace voxtone::calibration {

/// Of one g: a whole fit, checked on the patches of the fit or on others.
struct SweepLine {
    double g = 0;
    double chi2 = 0;                        ///< per channel and degree of freedom; 0 where there is none
    optics::DifferenceSummary differences;  ///< CIEDE2000
};

/// `others`: patches to check with; nullptr: those of the fit. Throws InputError as fit_resins does.
[[nodiscard]] std::vector<SweepLine> sweep_g(const PatchTable& table, const PatchTable* others, FitOptions options,
                                             const Progress& progress);

}  // namespace voxtone::calibration
