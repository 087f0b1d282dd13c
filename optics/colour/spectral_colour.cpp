// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/spectral_colour.h"

#include <array>

#include "base/contracts.h"
#include "optics/colour/cie_tables.h"
#include "optics/colour/colour.h"

namespace voxtone::optics {

namespace {

const std::array<double, cie::samples>& power_of(Illuminant illuminant) {
    switch (illuminant) {
        case Illuminant::d65:
            return cie::power_d65;
        case Illuminant::d50:
            return cie::power_d50;
        case Illuminant::a:
            return cie::power_a;
    }
    VOXTONE_EXPECT(!"an illuminant that is known");
    return cie::power_d65;
}

}  // namespace

Eigen::Matrix3Xd xyz_weights(std::span<const double> wavelengths_nm, Illuminant illuminant) {
    return cie::xyz_weights(wavelengths_nm, power_of(illuminant));
}

Eigen::Vector3d xyz_from_spectrum(std::span<const double> wavelengths_nm, std::span<const double> reflectance,
                                  Illuminant illuminant) {
    VOXTONE_EXPECT(wavelengths_nm.size() == reflectance.size());
    return xyz_weights(wavelengths_nm, illuminant) *
           Eigen::Map<const Eigen::VectorXd>(reflectance.data(), static_cast<Eigen::Index>(reflectance.size()));
}

Eigen::Matrix3Xd linear_srgb_weights(std::span<const double> wavelengths_nm) {
    if (wavelengths_nm.empty()) return Eigen::Matrix3d::Identity();
    Eigen::Matrix3Xd weights = xyz_weights(wavelengths_nm, Illuminant::d65);
    const Eigen::Vector3d white = weights.rowwise().sum();
    for (Eigen::Index c = 0; c < weights.cols(); ++c)
        weights.col(c) = linear_srgb_from_xyz(adapt_white(weights.col(c), white, d65_white()));
    return weights;
}

Eigen::Vector3d spectral_white(Illuminant illuminant) {
    const double anywhere = 560;
    return xyz_weights(std::span(&anywhere, 1), illuminant).col(0);
}

}  // namespace voxtone::optics
