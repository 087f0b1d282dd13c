// SPDX-License-Identifier: GPL-3.0-or-later
//
// One step of the appearance loop along the adjoint gradient: mixtures of every cell and layer of the skin move so that the whole
// print, not each cell for itself, comes nearer to its target.
//
//   F = sum over cells i of  a_i ( | W (oklab(E p)_i - oklab(E t)_i) |^2 + beta | W (oklab(p_i) - oklab(t_i)) |^2 ),
//
// p what is predicted, t the target, a_i the cell's area / mean area, W = diag(1, 2, 2), E the narrowest Gaussian of the eye
// filter. For contrast's sake the first difference d may be replaced by d - k S d, S a Gaussian eight times as wide: what is off over
// more than a millimetre counts less then, what is off from its surroundings in full. With k = 0 black text on white comes out
// pale: a little more light on the wide paper outweighs the few dark strokes. Feedback (residual_feedback.h) treats a cell as if only its own resins decided what it shows; the gradient knows
// that black beside white takes white's light, that deep ink blurs, and that a little less of it may be better for both.
//
// Fractions f move by exponentiated gradients (J. Kivinen, M. K. Warmuth, Information and Computation 132, 1997), which keep them
// positive and their sum 1:
//
//   f_r  <-  f_r exp(-rate m_r / s) / sum,     m  <-  mu m + (1 - mu) (g - <g>_f),
//
// s of a cell is the largest |g_r - <g>| sqrt(f_r) of all its layers, kept from falling faster than 10 % a step, plus a part of
// its mean over the cells: cells that are far off move at full rate, others settle. Fractions stay above `least`, so that a
// resin can come back; the screen leaves out what is below three times that.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "voxtone/halftone/eye_filter.h"
#include "voxtone/halftone/skin.h"
#include "voxtone/optics/appearance_model.h"

namespace voxtone::halftone {

/// F, and d F / d p.
struct Misfit {
    double value = 0;
    std::vector<Eigen::Vector3f> by_colour;
};

class MisfitFunction {
public:
    /// Keeps references. `wide`: S, null where contrast has no privilege; `contrast_part`: k, in [0, 1].
    MisfitFunction(const optics::Surface& surface, const EyeFilter& eye, std::span<const Eigen::Vector3f> target, const EyeFilter* wide = nullptr,
                   float contrast_part = 0);
    [[nodiscard]] Misfit operator()(std::span<const Eigen::Vector3f> predicted) const;

private:
    const EyeFilter& eye_;
    const EyeFilter* wide_;
    float contrast_part_;
    std::span<const Eigen::Vector3f> target_;
    std::vector<Eigen::Vector3f> seen_target_;
    std::vector<float> area_;
};

struct DescentOptions {
    float rate = 0.3f;      ///< of the first step, in (0, 2]
    float most_rate = 0.42f;
    float momentum = 0.4f;  ///< mu, in [0, 1); more makes bodies swing, whose cells share light over millimetres
    float shared = 0.5f;    ///< part of the cells' mean in s
    float slower = 0.6f, forget = 0.3f;  ///< factors of rate and momentum where F rose
    float faster = 1.3f;                 ///< of the rate where it fell
    float ceiling = 0.75f;               ///< the rate stays below this part of each rate with which F rose
};

/// What a descent carries from step to step.
struct DescentState {
    SkinMixtures mixtures;
    std::vector<float> momentum;  ///< as mixtures
    std::vector<float> scale;     ///< s, per cell
    float rate = 0;
    float most_rate = 0;          ///< that it may rise to
    double misfit = 0;            ///< F at the last step
};

inline constexpr double wider = 8;             ///< the spread of S / that of E
inline constexpr float least_fraction = 1e-3f;

/// Fractions kept above `least_fraction`; no momentum.
[[nodiscard]] DescentState begin_descent(SkinMixtures mixtures, const DescentOptions& options);

/// `gradient`: d F / d fraction of every cell, layer and resin. Slower where F rose.
void descend(std::span<const float> gradient, double misfit, const DescentOptions& options, DescentState& state);

/// As they are printed: fractions that are below three times `least_fraction` are left out.
[[nodiscard]] SkinMixtures printed(const SkinMixtures& mixtures);

}  // namespace voxtone::halftone
