// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a fit of edge profiles has to say: as text for people, as one JSON object for programs.
//
//   {"format": "voxtone-edge-fit", "version": 1, "g", "eta", "mu", "mu_error", "total", "lambda", "seconds",
//   "warnings":
//   [...],
//    "mu_curve": [[mu, E], ...], "resins": [{"role", "g", "g_error", "by_g": [[g, distance], ...], "channels":
//    [{"channel", "from", "sigma_t_per_mm": VALUE, "albedo": VALUE, "covariance_v_ln_sigma_t": [vv, vl, ll],
//    "distance", "similar": [{"g", "sigma_t_fitted", "sigma_t_similar", "albedo_fitted", "albedo_similar"}, ...]}]}]}
//    (similar: where g was found, or a page was drawn from a dictionary of several g)
//   "from": "edges", or "edges and chart" where a chart completed the channel; then "edges": {"sigma_t_per_mm": VALUE,
//   "albedo": VALUE} is what edges alone say, and the covariance is theirs. With a chart also "chart": {"source",
//   "patches", "completed", "mean_de2000", "rms"}.
//   VALUE: {"value", "standard_error", "low", "high", "doubts": [...]}
#pragma once

#include <string>

#include "calibration/edge/edge_fit.h"

namespace voxtone::calibration {

[[nodiscard]] std::string edge_fit_text(const EdgeFit& fit);
[[nodiscard]] std::string edge_fit_json(const EdgeFit& fit, const EdgeFitOptions& options);

}  // namespace voxtone::calibration
