// SPDX-License-Identifier: GPL-3.0-or-later
//
// One channel of a target: all resins at once by least squares.
//
//   minimise sum_p ((rho_p(v, ln sigma_t) - rho_p*) / e_p)^2    over v and ln sigma_t (resin_coordinates.h) of all
//
// by Levenberg-Marquardt within bounds (Ceres), with the model's exact derivatives, from the start of the Principles.
// Where Eq. 6 has other local minima, each resin is first fitted by itself from each of them and the deepest is taken.
// The covariance is the inverse of J^T J, taken with bounds open: a value that lies on a bound keeps the error that it
// would have beside it.
//
// What is known before (resin_prior.h) adds two residuals a resin, W (x - x_0) with W W = its precision. A resin that
// it knows starts there; one that it does not know in full is searched by brute force, the others held, before the
// least squares.
//
// Clear resin scatters nothing: its v is 1 and stays. Where a square of it is deep enough to tell (clear_is_told), its
// ln sigma_t = ln sigma_a is fitted with the others' values, else it is nothing.
//
// A resin so opaque that its patches would look the same at the largest extinction (chi2 within 1 of the least) has no
// least squares worth the name: its extinction is then the lower limit, where chi2 is 1 above the least.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "calibration/fit/principles.h"
#include "calibration/resins/resin_prior.h"

namespace voxtone::calibration {

struct ChannelFit {
    std::vector<ResinPoint> resins;  ///< one per role; clear ones that are not fitted mean nothing
    std::vector<ResinPoint> errors;  ///< standard errors of both coordinates; huge where nothing tells
    std::vector<ResinPoint> beyond;  ///< where the least squares would lie without bounds, to first order
    Eigen::MatrixXd covariance;      ///< of v and ln sigma_t of each role in turn; 0 for what is not fitted
    std::vector<double> predicted;   ///< rho of each patch
    double chi2 = 0;                 ///< sum of squared residuals / noise^2, those of the prior too
    double least_chi2 = 0;           ///< the same before resins that are opaque were limited
    int freedom = 0;                 ///< patches + values of the prior - fitted values
    std::vector<double> prior_chi2;  ///< of each role: its squared distance from the prior; empty without one
    std::vector<bool> v_low, v_high, sigma_low, sigma_high;  ///< on a bound
    std::vector<bool> opaque;                                ///< ln sigma_t is a lower limit
    std::vector<bool> second;  ///< another set of values of this resin explains its patches nearly as well
    int evaluations = 0;       ///< of the whole target
};

/// Whether squares of clear resin upon a base are thick enough, 2 mm, that their absorption is fitted.
[[nodiscard]] bool clear_is_told(const PatchTable& table, const std::string& role);

class ChannelFitter {
public:
    /// `prior` has the g and eta of `options`.
    ChannelFitter(const PatchTable& table, const TargetRoles& roles, const PatchModelOptions& options, double noise,
                  const ResinPrior& prior = {});
    [[nodiscard]] ChannelFit fit(std::size_t channel) const;

private:
    struct Part {
        std::vector<std::size_t> patches;
        std::unique_ptr<PatchModel> model;
    };
    class Residuals;
    [[nodiscard]] Part part(std::vector<std::size_t> patches) const;
    /// Moves the resins `free` to the least squares of a part, the extinctions of `held` staying; returns chi2.
    double solve(const Part& part, std::size_t channel, const std::vector<std::size_t>& free, bool bases_move,
                 std::vector<ResinPoint>& resins, int& evaluations, const std::vector<std::size_t>& held = {}) const;
    void limit_opaque(std::size_t channel, const std::vector<std::size_t>& free, ChannelFit& fit) const;
    [[nodiscard]] PriorValue prior(std::size_t role, std::size_t channel) const;
    [[nodiscard]] optics::Medium medium_at(std::size_t role, const ResinPoint& point) const;
    [[nodiscard]] ResinBounds bounds_of(std::size_t role) const;
    void start_at_prior(std::size_t channel, ChannelStart& start) const;
    [[nodiscard]] std::vector<ResinPoint> brute_force(std::size_t role, std::size_t channel,
                                                      const std::vector<ResinPoint>& resins) const;
    void compare_with_prior(std::size_t channel, ChannelFit& fit) const;
    void choose_minima(std::size_t channel, const ChannelStart& start, ChannelFit& fit) const;
    void errors(std::size_t channel, const std::vector<std::size_t>& free, ChannelFit& fit) const;

    const PatchTable* table_;
    TargetRoles roles_;
    PatchModelOptions options_;
    double noise_;
    ResinPrior prior_;
    std::shared_ptr<const optics::OrdinatePlan> plan_;
    ResinBounds bounds_;
    std::vector<bool> fitted_;  ///< of each role
    Principles principles_;
    Part whole_;
    std::vector<Part> of_resin_;  ///< patches whose square holds the resin; empty for bases and clear resin
};

}  // namespace voxtone::calibration
