// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a fit or a check has to say: as text for people, as one JSON object for programs.
//
//   {"format": "voxtone-fit", "version": 1, "g", "eta", "seconds", "freedom", "channels": [...], "chi2": [...],
//    "misfit": [...], "dot_spread": {"value", "error" or 0 where it was not fitted}, "warnings": [...],
//    "spread": {"mm": [x, y], "error", "chi2", "freedom"} where there were checkers,
//    "square_ends": the largest that was taken from a value, where the target is known,
//    "resins": [{"role", "channels": [{"channel", "albedo": VALUE, "sigma_t_per_mm": VALUE, "reduced_per_mm":
//    VALUE}]}], "patches": PATCHES}, and where asked for "check": a voxtone-check, "g_sweep": [{"g",
//    "chi2_per_freedom", "mean_de2000", ...}]
//   {"format": "voxtone-check", "version": 1, "patches": PATCHES}
//   VALUE: {"value", "standard_error", "low", "high", "doubts": [...]}
//   PATCHES: {"mean_de2000", "median_de2000", "p95_de2000", "max_de2000", "rms",
//             "list": [{"patch", "thickness_mm", "de2000", "measured", "predicted"}]}
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/g_sweep.h"
#include "calibration/fit/resin_fit.h"
#include "calibration/fit/spread_fit.h"
#include "io/files/json_writer.h"

namespace voxtone::calibration {

/// What was asked for beside the fit.
struct FitExtras {
    std::optional<PatchCheck> check = {};
    const PatchTable* checked = nullptr;  ///< what was checked; nullptr: nothing
    std::vector<SweepLine> sweep = {};
    std::optional<SpreadFit> spread = {};  ///< of checkers
    std::optional<double> ends = {};       ///< the largest that was taken from a value (ended_fit.h)
};

/// VALUE of above.
void add_value(io::JsonWriter& json, const char* key, const FittedValue& value);
/// What the fit found of the dot spread; empty where it was not fitted.
[[nodiscard]] std::string dot_spread_sentence(const ResinFit& fit);
/// Empty where there were no checkers.
[[nodiscard]] std::string spread_sentence(const std::optional<SpreadFit>& spread);
[[nodiscard]] std::string fit_text(const ResinFit& fit, const PatchTable& table);
[[nodiscard]] std::string fit_json(const ResinFit& fit, const PatchTable& table, const FitExtras& extras = {});
[[nodiscard]] std::string check_text(const PatchCheck& check, const PatchTable& table);
[[nodiscard]] std::string check_json(const PatchCheck& check, const PatchTable& table);
[[nodiscard]] std::string sweep_text(const std::vector<SweepLine>& lines);

}  // namespace voxtone::calibration
