// SPDX-License-Identifier: GPL-3.0-or-later
//
// Targets brought into the gamut before the loop, their local contrast kept.
//
// A mapping of colour by colour sends all that is darker than the darkest print to one black: detail in shadows is gone
// before the loop begins. After R. Bala, R. deQueiroz, R. Eschbach, W. Wu, Gamut mapping to preserve spatial luminance
// variations, J. Imaging Sci. Technol. 45 (5), 2001, what the mapping took from the lightness is given back without its
// local mean:
//
//   t' = G(G(t) + (d - S d)),   d = L(t) - L(G(t)),
//
// G the mapping, L Oklab's lightness, S a Gaussian of a millimetre or so over the surface. Cells that lie in the gamut
// stay as they are.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/eye_filter.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

/// Linear sRGB per cell of the surface. `into_gamut`: G; called from several threads. `spread`: gives S
/// (EyeFilter::smoothed); called where there is anything out of the gamut.
[[nodiscard]] std::vector<Eigen::Vector3f> map_targets(
    std::span<const Eigen::Vector3f> target, const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut,
    const std::function<const EyeFilter&()>& spread);

}  // namespace voxtone::halftone
