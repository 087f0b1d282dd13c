// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which cells of two resins tell how far they run (calibration/fit/spread_fit.h).
#pragma once

#include <algorithm>
#include <cmath>

#include "calibration/resins/resin_coordinates.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct CheckerContrast {
    double darker = 0;  ///< a mixture than its resins side by side, of a reflectance, nearly (resin_coordinates.h)
    double per_mm = 0;  ///< that by how far light goes in the mixture: finer cells look mixed though they are not
};

[[nodiscard]] inline CheckerContrast checker_contrast(const optics::Medium& one, const optics::Medium& other,
                                                      double g) {
    const optics::Medium mixed{(one.sigma_a + other.sigma_a) / 2, (one.sigma_s + other.sigma_s) / 2};
    const double darker = point_of(mixed, g).v - (point_of(one, g).v + point_of(other, g).v) / 2;
    const double transport = mixed.sigma_a + mixed.sigma_s * (1 - g);
    return {darker, darker * std::sqrt(3 * mixed.sigma_a * transport)};
}

}  // namespace voxtone::calibration
