// SPDX-License-Identifier: GPL-3.0-or-later
//
// From reflectance spectra to XYZ:  X = sum_l E(l) xbar(l) rho(l) / sum_l E(l) ybar(l), and likewise Y and Z.
//
// Tables: CIE 1931 2-degree observer and illuminants D65, D50 and A, 380 to 780 nm in steps of 5 nm (sources in
// spectral_colour.cpp). A perfect diffuser has Y = 1 exactly; the summed white of D65 is (0.95043, 1, 1.08880), which
// differs from sRGB's white in the fourth digit: use `spectral_white` as the white of what was computed here.
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "base/named_values.h"

namespace voxtone {

namespace optics {
enum class Illuminant { d65, d50, a };
}

template <>
struct NamesOf<optics::Illuminant> {
    static constexpr auto table = std::to_array<Named<optics::Illuminant>>(
        {{optics::Illuminant::d50, "D50"}, {optics::Illuminant::d65, "D65"}, {optics::Illuminant::a, "A"}});
};

namespace optics {

/// Columns w such that XYZ = weights * rho for reflectances at these wavelengths (nm, rising, at least one). Between
/// them the spectrum is linear, beyond the first and last constant.
[[nodiscard]] Eigen::Matrix3Xd xyz_weights(std::span<const double> wavelengths_nm, Illuminant illuminant);

[[nodiscard]] Eigen::Vector3d xyz_from_spectrum(std::span<const double> wavelengths_nm,
                                                std::span<const double> reflectance, Illuminant illuminant);

/// Columns w such that linear sRGB = weights * rho, under D65, white adapted to (1, 1, 1) (Bradford): the colour of a
/// spectrum for the eye. No wavelengths: rho is linear sRGB already, and the weights are the identity.
[[nodiscard]] Eigen::Matrix3Xd linear_srgb_weights(std::span<const double> wavelengths_nm);

/// XYZ of a perfect diffuser.
[[nodiscard]] Eigen::Vector3d spectral_white(Illuminant illuminant);

}  // namespace optics

}  // namespace voxtone
