// SPDX-License-Identifier: GPL-3.0-or-later
//
// What edge profiles know of resins (calibration/resins/resin_prior.h) beside a chart of thick mixtures, in one least
// squares: they tell lengths, resin by resin. Edges are seen in R, G and B, charts are fitted in channels of their own;
// channel j of the edges sees of a resin
//
//   rho_j = sum_c m_jc rho_c                       m: linear sRGB of channel c (optics::linear_srgb_weights), signed
//   ln sigma_t,j = sum_c m_jc rho_c ln sigma_t,c / rho_j
//
// to first order in how channels differ: light of a channel tells of its length in proportion to what comes back of it.
// The differences d of v(rho_j), rho being that of a thick piece, and ln sigma_t,j from what was measured make two
// residuals L^T d, L L^T the precision. To first order is not all: 0.02^2 and 0.1^2 are added to the variances, chosen
// on drawn resins of four channels (tests/calibration/chart/edge_values_test.cpp).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/chart/observer_model.h"
#include "calibration/resins/resin_prior.h"

namespace voxtone::calibration {

/// Of one resin in one channel of the edges.
struct EdgePriorValue {
    Eigen::Index resin = 0;    ///< of the chart's
    Eigen::Index channel = 0;  ///< R, G, B
    PriorValue value;
};

/// What a prior says of these roles; others are left out.
[[nodiscard]] std::vector<EdgePriorValue> edge_values(const ResinPrior& prior, const std::vector<std::string>& roles);

/// The residuals of all, two each; weights are those of the illuminant's white. Contract: the parts know lengths.
[[nodiscard]] Eigen::VectorXd edge_residuals(const std::vector<EdgePriorValue>& values, const ObserverModel& model,
                                             const ObserverParts& parts, optics::Illuminant illuminant);

/// A sentence for each value that fit and edges disagree about: a difference that chance exceeds once in a thousand
/// times.
[[nodiscard]] std::vector<std::string> edge_disagreements(const std::vector<EdgePriorValue>& values,
                                                          const Eigen::VectorXd& residuals,
                                                          const std::vector<std::string>& roles);

}  // namespace voxtone::calibration
