// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a camera reads of a target's squares more or less than of such squares without end: in white resin light goes
// millimetres far, so that the middle of a bright square lacks what its neighbours swallow, and that of a dark one gets
// some of theirs.
//
// Diffusion on a grid of the target (cells of about a millimetre, thin layers on top), once with and once without
// exchange between its columns:
//
//   -div(D grad phi) + sigma_a phi = q,   D = 1 / (3 sigma_t'),   sigma_t' = sigma_a + (1 - g) sigma_s
//
// q: the beam of 45 degrees scattered once, seen from straight above; partial currents at surfaces (refractive index).
// What a square loses is taken as the share of its own light that diffusion has it lose, what it gets as it stands:
// against light paths (benchmarks/calibration/target/finite-squares) within 0.004 of effects of up to 0.018.
//
// Not seen: voxels (mixtures are ideal), light led sideways in clear layers, the outermost sides.
#pragma once

#include <vector>

#include "calibration/target/target_layout.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

/// Of a square's edge, as `calibrate photo` does.
inline constexpr double sampled_share = 0.6;

/// pi L / E of the middle 60 % of a square (as much as `calibrate photo` samples) by diffusion in one channel.
struct SquareLight {
    double alone = 0;     ///< if the square had no end
    double together = 0;  ///< among its neighbours
    /// Seen more than a square without end shows, whose reflectance is rho.
    [[nodiscard]] double more(double rho) const;
};

using LightOfSquares = std::vector<std::vector<SquareLight>>;

/// Of deep squares (clear_wells.h); nothing for the others.
[[nodiscard]] LightOfSquares light_of_deep_squares(const Target& target, const optics::ResinSet& resins,
                                                   double paths = 20000);

/// By square and channel; deep squares are those of `deep`. Throws InputError where the set lacks a resin of the
/// target. `air_below`: the base ends in air, else in a black that touches it.
[[nodiscard]] LightOfSquares light_of_squares(const Target& target, const optics::ResinSet& resins, bool air_below,
                                              const LightOfSquares& deep);

}  // namespace voxtone::calibration
