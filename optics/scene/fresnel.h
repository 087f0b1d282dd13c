// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reflection of unpolarised light at a smooth boundary between two clear media (Fresnel 1823; Born and Wolf, Principles
// of Optics, 7th ed., Sec. 1.5.2). Exact for real refractive indices; no roughness, no polarisation.
#pragma once

#include <cmath>

namespace voxtone::optics {

/// Cosine inside the resin of the angle of total reflection: rays with a smaller cosine cannot leave. 0 where eta is 1.
[[nodiscard]] inline double critical_cosine(double eta) { return eta > 1 ? std::sqrt(1 - 1 / (eta * eta)) : 0.0; }

/// Cosine in the resin of a ray whose cosine in air is mu (Snell).
[[nodiscard]] inline double cosine_in_resin(double mu, double eta) {
    return std::sqrt(1 - (1 - mu * mu) / (eta * eta));
}

/// Share of the flux reflected for a ray in air with cosine mu in (0, 1] to the normal, resin of index eta >= 1 below.
/// The same for the ray that takes that path backwards. 1 at grazing incidence, ((eta - 1)/(eta + 1))^2 at normal
/// incidence.
[[nodiscard]] inline double fresnel_reflectance(double mu, double eta) {
    const double nu = cosine_in_resin(mu, eta);
    const double s = (mu - eta * nu) / (mu + eta * nu);
    const double p = (eta * mu - nu) / (eta * mu + nu);
    return 0.5 * (s * s + p * p);
}

}  // namespace voxtone::optics
