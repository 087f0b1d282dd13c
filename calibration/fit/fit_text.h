// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a fit or a check has to say: as text for people, as one JSON object for programs.
//
//   {"format": "voxtone-fit", "version": 1, "g", "eta", "seconds", "freedom", "channels": [...], "chi2": [...],
//    "misfit": [...], "resins": [{"role", "channels": [{"channel", "albedo": VALUE, "sigma_t_per_mm": VALUE,
//    "reduced_per_mm": VALUE}]}], "patches": PATCHES}
//   {"format": "voxtone-check", "version": 1, "patches": PATCHES}
//   VALUE: {"value", "standard_error", "low", "high", "doubts": [...]}
//   PATCHES: {"mean_de2000", "median_de2000", "p95_de2000", "max_de2000", "rms",
//             "list": [{"patch", "thickness_mm", "de2000", "measured", "predicted"}]}
#pragma once

#include <string>
#include <vector>

#include "voxtone/calibration/fit/resin_fit.h"

namespace voxtone::calibration {

[[nodiscard]] std::string fit_text(const ResinFit& fit, const PatchTable& table);
[[nodiscard]] std::string fit_json(const ResinFit& fit, const PatchTable& table);
[[nodiscard]] std::string check_text(const PatchCheck& check, const PatchTable& table);
[[nodiscard]] std::string check_json(const PatchCheck& check, const PatchTable& table);

/// One line of a sweep over g (Sec. 6.6): a whole fit, checked on the patches of the fit or on others.
struct SweepLine {
    double g = 0;
    double chi2 = 0;                        ///< per channel and degree of freedom
    optics::DifferenceSummary differences;  ///< CIEDE2000
};
[[nodiscard]] std::string sweep_text(const std::vector<SweepLine>& lines);
[[nodiscard]] std::string sweep_json(const std::vector<SweepLine>& lines);

}  // namespace voxtone::calibration
