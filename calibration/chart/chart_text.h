// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the fit of a chart has to say: as text for people, as one JSON object for programs.
//
//   {"format": "voxtone-chart-fit", "version": 1, "seconds", "channels", "mixtures", "fitted": DIFFERENCES,
//    "held_out": DIFFERENCES, "held_out_physics": DIFFERENCES, "repeats": DIFFERENCES,
//    "squares_held_out": DIFFERENCES, "length_error": [relative, by channel], "dot_spread": {"value", "error"},
//    "residual": {"centres", "mean_de2000"}, "measured": {"surface", "gain"},
//    "curve": [{"channels", "physics", "with_residual"}], "chosen_anew", "residual_anew", "worst": [{"mixture",
//    "de2000"}], "solids": [...], "warnings": [...]}
//   DIFFERENCES: {"count", "mean_de2000", "median_de2000", "p95_de2000", "max_de2000"}
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibration/chart/chart_fit.h"
#include "io/files/json_writer.h"

namespace voxtone::calibration {

/// A table of differences: its heading, and a line of it.
[[nodiscard]] std::string difference_heading();
[[nodiscard]] std::string difference_line(std::string_view what, const optics::DifferenceSummary& differences);
/// One JSON object within another.
void add_differences(io::JsonWriter& json, std::string_view key, const optics::DifferenceSummary& differences);
/// A list of objects: `name`, and how far the patch is off.
void add_patches(io::JsonWriter& json, std::string_view key, std::string_view name,
                 const std::vector<HeldOutPatch>& patches);

/// What of the held-out figures was chosen on the mixtures that they judge, and what that flatters; sentences.
[[nodiscard]] std::string honesty_of(const ChartFit& fit);
[[nodiscard]] std::string chart_fit_text(const ChartFit& fit);
[[nodiscard]] std::string chart_fit_json(const ChartFit& fit);

}  // namespace voxtone::calibration
