// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page to look at after a fit of edge profiles: its text (edge_fit_text.h) beside the published fit errors, slabs
// measured and simulated side by side (Fig. 2), the curve of mu (Fig. 6), per resin and channel the measured and the
// fitted profiles with their gradients (Fig. 7) and neighbours in the dictionary (Figs. 3, 5), maps of the distance
// with similar media (Fig. 9), and the setup.
#pragma once

#include <string>

#include "calibration/edge/edge_fit.h"
#include "calibration/edge/edge_similarity.h"

namespace voxtone::calibration {

/// One HTML file (io/report/report_html.h).
[[nodiscard]] std::string edge_report_html(const EdgeFit& fit, const std::vector<EdgeProfile>& profiles,
                                           const EdgeProfileTable& table, const EdgeFitOptions& options,
                                           const EdgeSimilarity& similarity);

}  // namespace voxtone::calibration
