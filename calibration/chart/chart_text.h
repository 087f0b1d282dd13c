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
//   of laminates {"format": "voxtone-layer-fit", "version": 1, "seconds", "channels", "laminates", "fitted":
//   DIFFERENCES,
//    "held_out": DIFFERENCES, "worst": [{"laminate", "de2000"}], "measured": {"surface", "gain"}, "warnings": [...]}
//   of their check {"format": "voxtone-layer-check", "version": 1, "laminates": DIFFERENCES, "worst": [...]}
//   DIFFERENCES: {"count", "mean_de2000", "median_de2000", "p95_de2000", "max_de2000"}
#pragma once

#include <string>
#include <vector>

#include "calibration/chart/chart_fit.h"
#include "calibration/patches/patch_check.h"
#include "io/files/json_writer.h"
#include "io/report/report.h"

namespace voxtone::calibration {

/// How far off a fit is, for its text, its JSON object and its page alike.
struct FitFigures {
    struct Line {
        std::string key, name;  ///< in JSON, and in words
        optics::DifferenceSummary of;
    };
    std::vector<Line> lines;  ///< in JSON all, else those that count something
    std::string patch;        ///< what is off: "mixture", "laminate"
    std::vector<HeldOutPatch> worst;
};
[[nodiscard]] std::string figures_text(const FitFigures& figures);
void add_figures(io::JsonWriter& json, const FitFigures& figures);
[[nodiscard]] io::ReportSection figures_section(const FitFigures& figures, const std::string& title);
[[nodiscard]] io::ReportTable patches_table(const std::string& title, const std::string& name,
                                            const std::vector<HeldOutPatch>& patches);
/// "The instrument sees 1.50 % of neutral light from the surface; its gain is 1.000"
[[nodiscard]] std::string instrument_sentence(const optics::ResinSet& set);

[[nodiscard]] FitFigures figures_of(const ChartFit& fit);
/// What of the held-out figures was chosen on the mixtures that they judge, and what that flatters; sentences.
[[nodiscard]] std::string honesty_of(const ChartFit& fit);
[[nodiscard]] std::string chart_fit_text(const ChartFit& fit);
[[nodiscard]] std::string chart_fit_json(const ChartFit& fit);
/// What a set says of laminates.
[[nodiscard]] std::string laminate_check_text(const PatchCheck& check, const PatchTable& table);
[[nodiscard]] std::string laminate_check_json(const PatchCheck& check, const PatchTable& table);

}  // namespace voxtone::calibration
