// SPDX-License-Identifier: GPL-3.0-or-later
//
// How even a print's flat areas are: paper and solids, which a person knows to be of one colour.
//
// With L_i what is seen of target and print in Lab (after the eye filter, whose wide Gaussians carry the neighbours'
// colour into a region of the target, too), e_i = L_i(print) - L_i(target), S the mean within the region over some 0.2
// mm (eight times that of a cell and those that touch it), a_i areas, <> means by area over the interior of a region
// (halftone/loop/colour_regions.h) and P = <L(print)>,
//
//   unevenness = sqrt(< CIEDE2000(P, P + e_i - (S e)_i)^2 >)
//
// so that a region which is off as a whole, or shades slowly, as beside a solid, is even, and one that is right on
// average and flecked is not. A solid is said to be flecked above 0.8, what half of all people see between two surfaces
// side by side (Paravina et al. 2015), paper above 0.5: that of a sign of 20 mm has 0.3 in the open loop, which is
// clean, and 0.95 after three iterations, which fleck it.
#pragma once

#include <span>

#include <Eigen/Core>

#include "halftone/loop/colour_regions.h"

namespace voxtone::slicer {

inline constexpr double paper_flecked_above = 0.5, flecked_above = 0.8;

/// `target`, `print`: linear sRGB per cell, as seen.
[[nodiscard]] double unevenness_of(const halftone::ColourRegion& region, const halftone::CellNeighbours& cells,
                                   std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> print);

}  // namespace voxtone::slicer
