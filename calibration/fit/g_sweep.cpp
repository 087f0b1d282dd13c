// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/g_sweep.h"

#include <numeric>

namespace voxtone::calibration {

std::vector<SweepLine> sweep_g(const PatchTable& table, const PatchTable* others, FitOptions options,
                               const Progress& progress) {
    std::vector<SweepLine> lines;
    for (int step = -9; step <= 9; ++step) {
        options.model.g = step / 10.0;
        const ResinFit fit = fit_resins(table, options, &progress);
        const double freedom = static_cast<double>(fit.freedom) * static_cast<double>(fit.chi2.size());
        lines.push_back({options.model.g,
                         freedom > 0 ? std::accumulate(fit.chi2.begin(), fit.chi2.end(), 0.0) / freedom : 0,
                         others ? check_resins(fit.set, *others, options.model).differences : fit.patches.differences});
    }
    return lines;
}

}  // namespace voxtone::calibration
