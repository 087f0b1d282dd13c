// SPDX-License-Identifier: GPL-3.0-or-later
//
// From edge profiles to resins (Elek et al. 2017, supplement, Sec. 5.5).
//
// Every resin and channel by itself: the medium whose simulated profiles are nearest over all its slabs
// (edge_objective.h). What all have in common is the factor mu that takes a constant bias out of the values, the
// minimum of
//
//   E(mu) = 1/mu sum over resins and channels of min d                                                    (Eq. 3)
//
// and g: given, one for all resins, or one each, found in the same way. A set of resins has one g; where resins have
// their own, they are brought to the set's by similarity (sigma_a and sigma_s (1 - g) kept; Eqs. 4 to 6).
//
// Errors are standard errors of v and ln sigma_t (calibration/resins/resin_coordinates.h): `low` and `high` lie one of
// them away; what they hold: edge_objective.h. That of mu: leaving out one resin after the other (jackknife).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "calibration/edge/edge_objective.h"
#include "calibration/fit/resin_fit.h"

namespace voxtone::calibration {

enum class EdgeAnisotropy { given, shared, each };

struct EdgeFitOptions {
    EdgeMetric metric;
    EdgeAnisotropy anisotropy = EdgeAnisotropy::given;
    double g = 0.4;                     ///< given, or what the set is brought to where resins have their own
    double mu_from = 0.8, mu_to = 1.1;  ///< searched; equal: mu is given
    double eta = 1.5;                   ///< of the set
    std::string name = "edges";
};

/// What edges alone say of a resin in a channel.
struct EdgesAlone {
    FittedValue sigma_t, albedo;
};

/// One resin in one channel.
struct EdgeValue {
    FittedValue sigma_t, albedo;                           ///< at the set's g
    std::optional<EdgesAlone> edges;                       ///< where a chart has completed it (edge_chart.h)
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of v and ln sigma_t at the set's g
    EdgePoint at = EdgePoint::Zero();                      ///< at the g that was fitted
    double distance = 0;                                   ///< Eq. 1 at the minimum
    bool told = false;                                     ///< slabs could be used, and tell both values
};

/// At another g: the best fit there, and the medium that is similar to the fitted one (Eqs. 4 to 6).
struct SimilarEdgeMedium {
    double g = 0;
    EdgeMedium fitted, similar;
};

struct EdgeResinFit {
    std::string role;
    double g = 0.4, g_error = 0;  ///< 0: given
    std::array<EdgeValue, 3> channel;
    std::array<std::vector<SimilarEdgeMedium>, 3> similar;  ///< per channel, for every g that was tried
    /// Per g that was tried: distance, summed over channels.
    std::vector<std::pair<double, double>> by_g;
};

/// The chart that completed what edges do not tell.
struct EdgeChart {
    std::string source;  ///< its file
    PatchCheck patches;  ///< predicted by edges and chart together
    int completed = 0;   ///< resins in a channel
};

struct EdgeFit {
    optics::ResinSet set;
    std::optional<EdgeChart> chart;
    std::vector<EdgeResinFit> resins;
    double mu = 1, mu_error = 0, total = 0;  ///< total: E(mu)
    std::vector<std::pair<double, double>> mu_curve;
    std::vector<std::string> warnings;
    double seconds = 0;
};

/// Throws InputError that names resin and slab.
[[nodiscard]] EdgeFit fit_edges(const std::vector<EdgeProfile>& profiles, EdgeProfileTable& table,
                                const EdgeFitOptions& options, const Progress* progress = nullptr);

}  // namespace voxtone::calibration
