// SPDX-License-Identifier: GPL-3.0-or-later
//
// The coordinates in which a resin is searched and fitted: v = ((1 - alpha) / (1 - alpha g))^(1/4) and ln sigma_t.
//
// The reflectance of a half-space is nearly linear in v from black (v = 1) to white (v = 0), where d rho / d alpha runs
// to infinity; extinctions are uncertain by factors. Errors are therefore near to normal in these coordinates where
// they are far from it in albedo and extinction.
#pragma once

#include <algorithm>
#include <cmath>

#include "optics/media/resins.h"

namespace voxtone::calibration {

struct ResinPoint {
    double v = 0.5;
    double ln_sigma_t = 0;  ///< of mm^-1
};

/// What is possible. Albedos: [0, 1 - 1e-7].
struct ResinBounds {
    double least_sigma_t = 0.02, most_sigma_t = 120;  ///< mm^-1
    double least_v = 0, most_v = 1;
};

/// Of resin that scatters nothing.
inline constexpr ResinBounds clear_bounds{.least_sigma_t = 1e-4, .most_sigma_t = 2, .least_v = 1, .most_v = 1};

[[nodiscard]] inline double v_of_albedo(double albedo, double g) {
    return std::pow((1 - albedo) / (1 - albedo * g), 0.25);
}

[[nodiscard]] inline double albedo_of_v(double v, double g) {
    const double x = v * v * v * v;
    return (1 - x) / (1 - g * x);
}

[[nodiscard]] inline double albedo_by_v(double v, double g) {
    const double x = v * v * v * v, d = 1 - g * x;
    return 4 * v * v * v * (g - 1) / (d * d);
}

[[nodiscard]] inline ResinBounds resin_bounds(double g) {
    ResinBounds bounds;
    bounds.least_v = v_of_albedo(1 - 1e-7, g);
    return bounds;
}

[[nodiscard]] inline ResinPoint clamped(ResinPoint p, const ResinBounds& b) {
    return {std::clamp(p.v, b.least_v, b.most_v),
            std::clamp(p.ln_sigma_t, std::log(b.least_sigma_t), std::log(b.most_sigma_t))};
}

[[nodiscard]] inline ResinPoint point_of(const optics::Medium& medium, double g) {
    return {v_of_albedo(medium.albedo(), g), std::log(medium.sigma_t())};
}

[[nodiscard]] inline optics::Medium medium_of(const ResinPoint& p, double g) {
    const double sigma_t = std::exp(p.ln_sigma_t), x = p.v * p.v * p.v * p.v, d = 1 - g * x;
    return {sigma_t * x * (1 - g) / d, sigma_t * (1 - x) / d};
}

}  // namespace voxtone::calibration
