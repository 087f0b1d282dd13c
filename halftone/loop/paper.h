// SPDX-License-Identifier: GPL-3.0-or-later
//
// A person who looks at a print takes its own paper for white: a sheet that is a tenth darker everywhere around its
// solids is not seen as wrong, rims and halos on it are. The level of a print's paper is
//
//   p = 1 - D A (1 - sum a_i w_i Y_i / T_i / sum a_i w_i),   A = share^2 / (share^2 + 0.1^2),   D = 0.85,
//
// Y_i the luminance that is predicted, relative to white resin, T_i that of the target, a_i areas, w_i how much of
// paper the target has: 1 from L* 98 on and where its least channel has 0.75 of the greatest (ivory, beige, cream), 0
// up to L* 93 or below 0.6 (light yellow); share = sum a_i w_i / sum a_i: where hardly anything is paper, p = 1. Nobody
// adapts wholly: D is CIECAM02's degree of adaptation in a room of 100 lux (CIE 159:2004; 0.84, and 0.91 in an office).
// One number for the print: that its paper has no colour is asked of it.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

/// w, from linear sRGB.
[[nodiscard]] float paper_weight(const Eigen::Vector3f& target);

/// p. `print`: linear sRGB per cell, media-relative.
[[nodiscard]] float paper_level(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                                std::span<const Eigen::Vector3f> print);

}  // namespace voxtone::halftone
