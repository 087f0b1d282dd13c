// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the fit and the check of laminates have to say: as text for people, as one JSON object for programs.
//
//   {"format": "voxtone-layer-fit", "version": 1, "seconds", "channels", "laminates", "fitted": DIFFERENCES,
//    "held_out": DIFFERENCES, "measured": {"surface", "gain"}, "worst": [{"laminate", "de2000"}], "warnings": [...]}
//   {"format": "voxtone-layer-check", "version": 1, "laminates": DIFFERENCES, "worst": [...]}
//   DIFFERENCES as in calibration/chart/chart_text.h
#pragma once

#include <string>

#include "calibration/chart/chart_text.h"
#include "calibration/layers/layer_fit.h"

namespace voxtone::calibration {

[[nodiscard]] FitFigures figures_of(const LayerFit& fit);
[[nodiscard]] std::string layer_fit_text(const LayerFit& fit);
[[nodiscard]] std::string layer_fit_json(const LayerFit& fit);
[[nodiscard]] std::string layer_check_text(const LayerCheck& check);
[[nodiscard]] std::string layer_check_json(const LayerCheck& check);

}  // namespace voxtone::calibration
