// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is wanted of a point where only means over square cells are known: light enters all over one cell and is
// gathered all over another (optics/monte_carlo/sampled_bssrdf.h). `laminate factor` writes maps of that kind.
//
// Sums of J0 over the cells' middles are the wave of the means (Poisson's sum), without the blur that straight lines
// between samples would add; of an exponential fall of 0.4 mm and cells of 0.5 mm they are within 3 % up to 0.6 per
// mm, where lines lose 20 % (cell_waves_test.cpp). Beyond, shorter waves are taken for these.
#pragma once

#include <span>
#include <vector>

#include "optics/numerics/hankel.h"

namespace voxtone::scattering {

/// What is left of a wave of k per mm by two cells: the product of both transforms, mean over the directions.
[[nodiscard]] double left_by_cells(double k, double cell_mm);

/// Coefficients of R of a point, from P by knot (profile_rings.h), mm^-2.
[[nodiscard]] std::vector<double> waves_behind_cells(std::span<const double> P, double cell_mm,
                                                     const optics::HankelGrid& grid);

}  // namespace voxtone::scattering
