// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much light a profile sends back and how far: the figures that people compare profiles by.
#pragma once

#include <string>
#include <vector>

#include "optics/numerics/hankel.h"

namespace voxtone::scattering {

struct SpreadFigures {
    double total = 0;    ///< of one unit that enters
    double half_mm = 0;  ///< radius of the disc that half of that leaves through
    double most_mm = 0;  ///< and 80 % of it
};

[[nodiscard]] SpreadFigures spread_figures(const optics::HankelGrid& grid, const std::vector<double>& coefficients);

/// "R 0.5123 +- 0.0004, half of it within 0.61 mm, 80 % within 1.44 mm". `error`: standard error of the total; 0: not
/// known.
[[nodiscard]] std::string spread_text(char letter, const SpreadFigures& figures, double error = 0);

}  // namespace voxtone::scattering
