// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far resin runs before it is cured (optics/media/lateral_spread.h), from checkers of two known resins: the finer
// their cells, the more of them runs together, and the darker they are than large cells of the same resins.
//
//   minimise |r|^2 + y^T C^-1 y    over sigma_x, sigma_y and y,    r = (rho - rho_mc(sigma, x + y)) / error
//
// x: v and ln sigma_t of the resins as squares have told them, C their covariance, of all resins of a channel together:
// how dark black is, and how far light goes in white, say as much of small cells as how far resin runs, and what
// squares tell of them best is what their mixtures are like, not what each is. By Gauss and Newton, y marginalised:
// with P = dr / dy and S = dr / dsigma, least squares of S with the noise 1 + P C P^T.
//
// rho_mc: light paths (optics/monte_carlo) at 45/0 through shares of the two resins in parts of a cell, from the middle
// of one cell to that of its neighbour across both axes, with mirrors around, which is a checker without end. The same
// random numbers for every sigma make it smooth. Channels: of a pair those that tell nearly as much as the best, three
// at most (calibration/resins/checker_contrast.h). From the best of four equal spreads. Errors follow from the noise of
// readings and of paths, and from C.
//
// What it cannot see: resin that runs up or down, cells that are not where the file has them, droplets' own size (it is
// in sigma). Sides of squares: take_ends_off_checkers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/patches/patch_table.h"
#include "calibration/target/target_layout.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct SpreadFit {
    std::array<double, 2> mm{}, error{};  ///< standard deviations along x and y of the target, their standard errors
    double chi2 = 0;
    int freedom = 0;
    /// Whether it is told: errors are known, and one of the two is more than twice its own.
    [[nodiscard]] bool is_told() const;
};

/// By channel: covariance of v and ln sigma_t (calibration/resins/resin_coordinates.h) of each resin of a set in turn;
/// of its first ones, the others are known.
using ResinCovariance = std::vector<Eigen::MatrixXd>;

/// `noise`: of a reflectance where the table has no errors. `squares`: what is not known of `resins`; empty: nothing.
/// `paths` of a value; 0: as many as the noise deserves.
/// Contract: every patch is a checker. Throws InputError where the set lacks a resin or no channel tells anything.
[[nodiscard]] SpreadFit fit_spread(const PatchTable& checkers, const optics::ResinSet& resins, double noise,
                                   const ResinCovariance& squares = {}, std::uint32_t paths = 0,
                                   const Progress* progress = nullptr);

/// What light between squares does to checkers (square_ends.h).
void take_ends_off_checkers(PatchTable& checkers, const Target& target, const optics::ResinSet& resins, bool air_below);

}  // namespace voxtone::calibration
