// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far resin runs before it is cured (optics/media/lateral_spread.h), from checkers of two known resins: the finer
// their cells, the more of them runs together, and the darker they are than large cells of the same resins.
//
//   chi2(sigma_x, sigma_y) = sum over checkers and channels of ((rho - s rho_mc) / error)^2
//
// s: free for every strip, which is a pair of resins upon one base in one channel: what errors of the fitted resins do
// to all its cells tells nothing, how they differ does.
//
// rho_mc: light paths (optics/monte_carlo) at 45/0 through shares of the two resins in parts of a cell, from the middle
// of one cell to that of its neighbour across both axes, with mirrors around, which is a checker without end. The same
// random numbers for every sigma make it smooth. Channels: the three at most of a pair that lose most where cells run
// together. Found from the best of four equal spreads by Broyden's method. Errors follow from the noise of readings and
// of paths, and of the extinctions of the resins, which are moved with the spread at last, by slopes, within their
// own errors: how far light goes says as much of small cells as how far resin runs.
//
// What it cannot see: resin that runs up or down, cells that are not where the file has them, droplets' own size (it is
// in sigma). Sides of squares: take_ends_off_checkers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

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

/// Relative standard errors of extinctions, by resin and channel.
using ExtinctionErrors = std::vector<std::vector<double>>;

/// `noise`: of a reflectance where the table has no errors. `errors`: of `resins`; empty: they are known. `paths` of a
/// value; 0: as many as the noise deserves.
/// Contract: every patch is a checker. Throws InputError where the set lacks a resin or no channel tells anything.
[[nodiscard]] SpreadFit fit_spread(const PatchTable& checkers, const optics::ResinSet& resins, double noise,
                                   const ExtinctionErrors& errors = {}, std::uint32_t paths = 0,
                                   const Progress* progress = nullptr);

/// What light between squares does to checkers (square_ends.h).
void take_ends_off_checkers(PatchTable& checkers, const Target& target, const optics::ResinSet& resins, bool air_below);

}  // namespace voxtone::calibration
