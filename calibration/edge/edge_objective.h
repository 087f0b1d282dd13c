// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far simulated edge profiles are from measured ones, and the resin for which they are nearest (Elek et al. 2017,
// supplement, Eqs. 1 and 2):
//
//   d(F_A, F_S) = |F_A - F_S| + lambda | |grad F_A| - |grad F_S| |,   summed over thicknesses, mu F_A in place of F_A
//
// Norms are root mean squares over the samples, so that they do not depend on how many there are; gradients
// (wavelet_gradient.h) are per 0.0276 mm, the pitch of the paper's camera, so that lambda means the same for any pitch.
// One resin in one channel at one g: minimised over v and ln sigma_t (calibration/resins/resin_coordinates.h) by
// reweighted Gauss-Newton steps with Levenberg's damping from the best places of a coarse net.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/edge/edge_profiles.h"
#include "calibration/edge/profile_table.h"

namespace voxtone::calibration {

struct EdgeMetric {
    double lambda = 20;
    int wavelet_level = 3;
};

/// One slab in one channel.
struct EdgeObservation {
    std::size_t thickness = 0;  ///< index in the dictionary
    double stretch = 1;         ///< its thickness / that of the dictionary
    Eigen::VectorXd x, value, gradient, error;
    Eigen::MatrixXd sampling, sampling_gradient;  ///< from cells to samples, and to their gradients
    Eigen::MatrixXd see_softer;   ///< seen through more gel than there is: blurred by its standard error
    Eigen::MatrixXd see_thicker;  ///< of a slab a hundredth thicker, whose profile is as much wider
};

/// The slabs of a resin in a channel that can be used; `why` says of those that cannot. Throws InputError where a
/// slab's thickness is far from all of the dictionary, or x is not evenly spaced.
[[nodiscard]] std::vector<EdgeObservation> edge_observations(const std::vector<const EdgeProfile*>& slabs,
                                                             std::size_t channel, const EdgeProfileTable& table,
                                                             const EdgeMetric& metric, std::vector<std::string>& why);

/// v and ln sigma_t.
using EdgePoint = Eigen::Vector2d;
[[nodiscard]] EdgeMedium edge_medium(const EdgePoint& p, double g);

class EdgeObjective {
public:
    EdgeObjective(std::vector<EdgeObservation> slabs, std::size_t channel, const EdgeProfileTable& table,
                  const EdgeMetric& metric);

    [[nodiscard]] double operator()(const EdgePoint& p, double g, double mu) const;
    /// The nearest resin. `start`: none searches the coarse net.
    struct Minimum {
        EdgePoint at = EdgePoint::Zero();
        double distance = 0;
    };
    [[nodiscard]] Minimum minimum(double g, double mu) const;
    [[nodiscard]] Minimum minimum_from(const EdgePoint& start, double g, double mu) const;

    /// Covariance of v and ln sigma_t at a minimum, by what may be wrong, to first order: noise of samples, noise of
    /// the dictionary, thickness, gel, mu, and what the slabs disagree.
    [[nodiscard]] Eigen::Matrix2d covariance(const Minimum& minimum, double g, double mu, double mu_error) const;

    [[nodiscard]] const std::vector<EdgeObservation>& slabs() const { return slabs_; }
    [[nodiscard]] Eigen::VectorXd simulated(const EdgeObservation& slab, const EdgePoint& p, double g) const;
    [[nodiscard]] Eigen::VectorXd simulated_gradient(const EdgeObservation& slab, const EdgePoint& p, double g) const;
    [[nodiscard]] EdgePoint least() const { return least_; }
    [[nodiscard]] EdgePoint most() const { return most_; }

private:
    struct Residual;
    [[nodiscard]] std::vector<Residual> residuals(const EdgePoint& p, double g, double mu, bool with_slopes) const;
    [[nodiscard]] EdgePoint inside(const EdgePoint& p) const { return p.cwiseMax(least_).cwiseMin(most_); }
    [[nodiscard]] Eigen::VectorXd cells(const EdgeObservation& slab, const EdgePoint& p, double g) const;

    std::vector<EdgeObservation> slabs_;
    std::size_t channel_;
    const EdgeProfileTable* table_;
    EdgeMetric metric_;
    EdgePoint least_, most_;
};

}  // namespace voxtone::calibration
