// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page to look at after a fit of edge profiles: the setup, a table like the paper's Table 1 with errors, the curve of
// mu (Fig. 6), and per resin and channel the measured and the fitted profiles with their gradients (Fig. 7), and what
// is left of them.
#pragma once

#include <string>

#include "voxtone/calibration/edge/edge_fit.h"

namespace voxtone::calibration {

/// One HTML file without scripts.
[[nodiscard]] std::string edge_report_html(const EdgeFit& fit, const std::vector<EdgeProfile>& profiles,
                                           const EdgeProfileTable& table, const EdgeFitOptions& options);

}  // namespace voxtone::calibration
