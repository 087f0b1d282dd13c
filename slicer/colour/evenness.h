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
// average and flecked is not. What light does at edges is no fleck either, however steep: from (e - S e)_i is taken
// what a linear fit over the region's interior makes of t - S t with the terms t
//   Lab(blur(target)) - Lab(target) for Gaussians of 0.25 and 0.5 mm: neighbours' light, lines that run together;
//   n . (blur(x) - x) and 1 - |blur(n)| of places x and normals n, 0.5 mm: ridges, grooves and corners of bodies.
// A solid is said to be flecked above 0.8, what half of all people see between two surfaces side by side, and spoilt
// above 1.8, what half of them do not accept (Paravina et al. 2015, doi:10.1111/jerd.12149); paper, on which nothing
// else is looked at, from 0.6 of these on. Of a sign of 20 mm paper has 0.06 in the open loop and 0.34 in the loop.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/colour_regions.h"

namespace voxtone::slicer {

inline constexpr double flecked_above = 0.8, spoilt_above = 1.8, of_paper = 0.6;

/// What light at edges goes by, of a cell.
using EdgeTerms = Eigen::Matrix<double, 8, 1>;
/// `asked`: the target as given, linear sRGB; `seen`: as it is seen.
[[nodiscard]] std::vector<EdgeTerms> edge_terms(const optics::Surface& surface, std::span<const Eigen::Vector3f> asked,
                                                std::span<const Eigen::Vector3f> seen);

/// `target`, `print`: linear sRGB per cell, as seen; `edges`: per cell.
[[nodiscard]] double unevenness_of(const halftone::ColourRegion& region, const halftone::CellNeighbours& cells,
                                   std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> print,
                                   std::span<const EdgeTerms> edges);

}  // namespace voxtone::slicer
