// SPDX-License-Identifier: GPL-3.0-or-later
//
// One step of the appearance loop along the adjoint gradient: mixtures of every cell and layer of the skin move so that
// the whole print, not each cell for itself, comes nearer to its target (misfit.h). Feedback (residual_feedback.h)
// treats a cell as if only its own resins decided what it shows; the gradient knows that black beside white takes
// white's light, that deep ink blurs, and that a little less of it may be better for both.
//
// Fractions f move by exponentiated gradients (J. Kivinen, M. K. Warmuth, Information and Computation 132, 1997), which
// keep them positive and their sum 1:
//
//   f_r  <-  f_r exp(x_r) / sum,   x_r = rate_s e_r + rate_o (d_r - e_r),   d_r = -m_r / s,   e = S d,
//   m  <-  mu m + (1 - mu) (g - <g>_f),   g = d F / d f,   f = h + (1 - R h) p,
//
// p the fractions that are printed, R the number of resins.
//
// Light spreads for millimetres: a thousand cells that all become a little darker darken each other, and a step that
// suits each of them overshoots. So a step has two parts with rates of their own: what neighbours do alike, e, smoothed
// by a Gaussian S over the surface, and what each does for itself, d - e. The shared part has a rate for every resin: a
// little yellow more over some millimetres, where the eye averages colour, answers more stiffly than as much black.
// Each rate follows the secant rule by itself and place by place: where F falls by p0 per unit of a part at its
// beginning and by p1 at its end (both smoothed by S), its least lies at p0 / (p0 - p1) of it. The shared parts go less
// than so far: the others disturb them. The exponential lets scattered steps of both signs add ink (their mean is above
// 1), so the amounts of resin in a layer, smoothed by S, are brought back after the step to what the shared part alone
// makes of them: cells only pass resin on to their neighbours.
//
// s of a cell is the largest |g_r - <g>| sqrt(f_r) of all its layers, kept from falling faster than 10 % a step, plus a
// part of its mean over the cells: cells that are far off move at full rate, others settle. h lets a resin come and go
// without a jump and within a few steps: without it a thousandth of white in black would take ten to become a
// twentieth.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/skin.h"

namespace voxtone::halftone {

/// Of the first step, far from the target; exponents per unit of d. What else the descent is made of stands with its
/// origin in the source.
struct DescentRates {
    float own = 0.18f;     ///< rate_o
    float shared = 0.05f;  ///< rate_s
};

/// What a descent carries from step to step.
struct DescentState {
    SkinMixtures mixtures;        ///< f, all at least h
    std::vector<float> momentum;  ///< as mixtures
    std::vector<float> shared;    ///< e of the last step, as mixtures; empty before the first
    std::vector<float> scale;     ///< per cell
    std::vector<float> divisor;   ///< s of the last step, per cell
    std::vector<float> decrease;  ///< p0 of the last step: of each resin's shared part, then of the own part; per cell
    std::vector<float> rate;      ///< likewise
};

inline constexpr float least_fraction = 0.03f;  ///< h

/// S, in place.
using CellSmoothing = std::function<void(std::vector<Eigen::Vector3f>&)>;

/// From what is to be printed first, some resin in every layer; no momentum.
[[nodiscard]] DescentState begin_descent(SkinMixtures mixtures, const DescentRates& rates = {});

/// `gradient`: d F / d fraction of every cell, layer and resin; its contents are used up. `near`: of the most that
/// rates may become, in (0, 1]; less than all near the target, where steps swing.
void descend(std::vector<float> gradient, const CellSmoothing& smooth, DescentState& state, float near = 1);

/// As they are printed: (f - h) / (1 - R h).
[[nodiscard]] SkinMixtures printed(const SkinMixtures& mixtures);

}  // namespace voxtone::halftone
