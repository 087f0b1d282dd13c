// SPDX-License-Identifier: GPL-3.0-or-later
//
// One node of the separation: the fractions whose appearance is nearest to a target, by a projected Gauss-Newton method
// with Levenberg's damping (D. P. Bertsekas, "Projected Newton methods for optimization problems with simple
// constraints", SIAM J. Control Optim. 20, 1982).
//
// Unknowns are g_r >= 0 with f_r = h(g_r) / sum_s h(g_s), h(g) = g^2 + epsilon g: the sum of the fractions is 1 by
// itself, only bounds remain. Appearance falls as the square root of a small fraction, so it is nearly straight in g
// there, and epsilon keeps the derivative at g = 0 from vanishing.
//
// Written out, not Ceres's: a lattice asks for 68,921 of these problems of at most eight unknowns and three residuals,
// and all that a solver allocates and prepares for one would cost more than its few steps of fixed size.
#pragma once

#include <Eigen/Core>

#include "halftone/separation/appearance_colour.h"
#include "halftone/separation/mixture.h"
#include "halftone/separation/separation_options.h"

namespace voxtone::halftone {

using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_resins, 1>;

struct InvertedColour {
    Unknowns g;
    Unknowns fractions;
    double error = 0;  ///< sqrt of the first term: weighted Oklab distance to the target
    int iterations = 0;
};

/// `penalty`: lambda p_r per resin. `start` warm-starts; its size is the number of resins.
[[nodiscard]] InvertedColour invert_appearance(const AppearanceColour& colour, const Eigen::Vector3d& target_rgb,
                                               const Unknowns& penalty, const SeparationOptions& options,
                                               const Unknowns& start);

}  // namespace voxtone::halftone
