// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a printer's droplets run together (optics/media/effective_medium.h), from a target's own squares: pure resins
// say what they are, mixtures of them what becomes of them side by side.
//
//   chi2(s) = sum over channels of the least chi2 that any resins have with the dot spread s (channel_fit.h)
//
// on five values from 0 to 1. It is told where sharp voxels or ideal mixtures are refused: chi2 there is beyond the
// least by more than chance does once in a thousand times, in units of chi2 per degree of freedom where residuals are
// larger than the noise. Golden section between the neighbours of the best of the five finds it then; its standard
// error is where the parabola through three values is one such unit above the least.
//
// Target C measured as R, G, B: +- 1.0, 0.4, 0.2 for a noise of 0.005, 0.002, 0.001; target B +- 1.6, 0.65, 0.34 (the
// model's own patches). So a photograph does not tell it, an instrument may. What it cannot see: an error of the
// mixtures' law itself, which the spread makes up for.
#pragma once

#include "base/progress.h"
#include "calibration/fit/principles.h"
#include "calibration/resins/resin_prior.h"

namespace voxtone::calibration {

struct DotSpreadFit {
    double value = 0, error = 0;  ///< and its standard error; 0: it is not told
    double sharp = 0, ideal = 0;  ///< chi2 of 0 and of 1 above the least of the five, in the unit above
};

/// Whether a square holds a mixture; without one nothing depends on the spread.
[[nodiscard]] bool has_mixtures(const PatchTable& table);

/// As ChannelFitter takes them; `model`: its spread does not count. Contract: the voxels' pitch is known. A table
/// without mixtures, or without more values than unknowns, tells nothing.
[[nodiscard]] DotSpreadFit fit_dot_spread(const PatchTable& table, const TargetRoles& roles,
                                          const PatchModelOptions& model, double noise, const ResinPrior& prior,
                                          const Progress* progress = nullptr);

}  // namespace voxtone::calibration
