// SPDX-License-Identifier: GPL-3.0-or-later
//
// One step of the appearance loop by residual feedback: where the print is too dark, ask for more light, by as much as
// it lacks.
//
//   control^(1/3)  <-  control^(1/3) + gain ((E target)^(1/3) - (E predicted)^(1/3)),
//
// then into the gamut, per cell and channel; E is what the eye's narrowest Gaussian leaves of it (EyeFilter::smoothed).
// The wide ones of colour carry the light of white paper a millimetre into black, where it is many times what there is:
// black beside bluish paper would be asked for olive.
//
// The control colour of a cell is what the separation is asked for; it is what a flat print would show. Light that
// spreads below the surface makes the print blurred by a transfer function M with 0 < M <= 1, so that the error of each
// spatial frequency shrinks by 1 - gain M E in a step. Cube roots make a step of equal size equally visible. Without E
// a cell spends its ink, and its neighbours' light, on grain that nobody sees: the error as seen falls once and rises
// from then on, however short the steps are (docs/decisions/001).
//
// Local limits. Beside bright places no ink makes a cell dark, beside dark ones no white makes it bright, and each
// channel has its own limits: control colours end at the gamut's edge while the error stays. A channel is saturated
// when its control cannot follow the residual by more than half. The one that misses most is given up, and the others
// go where the colour, that channel as predicted, is nearest to the target:
//
//   min over the other channels of | W (Lab(v) - Lab(target)) |,   |W d| = CIEDE2000 of a small d half way between;
//
// then once more, if one of them cannot follow either. So white beside black turns grey and not blue: near grey a step
// of chroma is seen as well as two or three of lightness; and crimson that no sheet of one voxel can show turns pink
// and not grey: by the metric at the target, where chroma counts little, grey is nearer. That is the relaxed target of
// the cell (docs/decisions/002).
//
// Based on the idea of O. Elek et al., "Scattering-aware texture reproduction for 3D printing", ACM TOG 36, 6 (2017);
// the relaxation is our own. Gauss-Newton is written out for it: three unknowns, for each saturated cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::halftone {

struct FeedbackOptions {
    float gain = 1;           ///< in (0, 2)
    float most_step = 0.25f;  ///< largest change of a control colour's cube root in a step
};

/// Colours that are off their target by what is seen of the print: (target^(1/3) - (seen target^(1/3) -
/// seen^(1/3)))^3, per cell and channel, 0 at the least; linear sRGB.
[[nodiscard]] std::vector<Eigen::Vector3f> as_wrong_as_seen(std::span<const Eigen::Vector3f> target,
                                                            std::span<const Eigen::Vector3f> seen_target,
                                                            std::span<const Eigen::Vector3f> seen);

/// Moves `control` (linear sRGB per cell, in gamut). `into_gamut` maps any colour in [0, 1]^3 to one that can be shown.
/// `relaxed`: what the cell is asked for now (the target where nothing is saturated). Returns how many cells are
/// asked for another colour than their target.
std::size_t feed_back(std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> predicted,
                      const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut,
                      const FeedbackOptions& options, std::span<Eigen::Vector3f> control,
                      std::span<Eigen::Vector3f> relaxed);

/// The colour nearest to `target` (by CIEDE2000's metric half way) whose channels in `saturated` are those of `from`.
[[nodiscard]] Eigen::Vector3f nearest_colour(const Eigen::Vector3f& target, const Eigen::Vector3f& from,
                                             const std::array<bool, 3>& saturated);

}  // namespace voxtone::halftone
