// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/separation/appearance_colour.h"

#include <fmt/core.h>

#include "voxtone/base/error.h"
#include "voxtone/optics/colour/spectral_colour.h"

namespace voxtone::halftone {

AppearanceColour::AppearanceColour(const optics::ShellAppearance& appearance, std::span<const double> wavelengths_nm)
    : appearance_(appearance) {
    const std::size_t channels = wavelengths_nm.empty() ? 3 : wavelengths_nm.size();
    if (appearance.channels() != channels)
        throw InputError(
            fmt::format("colour separation was told of {} channels, but the resin set has {}: without their "
                        "wavelengths its colour is unknown; give one wavelength per channel",
                        channels, appearance.channels()));
    if (wavelengths_nm.empty()) return;
    from_spectrum_ = optics::linear_srgb_weights(wavelengths_nm);
}

Eigen::Vector3d AppearanceColour::rgb(std::span<const double> fractions) const {
    Eigen::Vector3d colour;
    if (from_spectrum_.size() == 0) {
        appearance_.media_relative(fractions, {colour.data(), 3});
        return colour;
    }
    Eigen::VectorXd spectrum(from_spectrum_.cols());
    appearance_.media_relative(fractions, {spectrum.data(), std::size_t(spectrum.size())});
    return from_spectrum_ * spectrum;
}

Eigen::Vector3d AppearanceColour::rgb(std::span<const double> fractions, Gradient& gradient) const {
    const auto n = static_cast<Eigen::Index>(fractions.size());
    gradient.resize(3, n);
    Eigen::Vector3d colour;
    if (from_spectrum_.size() == 0) {
        appearance_.media_relative(fractions, {colour.data(), 3}, {gradient.data(), std::size_t(3 * n)});
        return colour;
    }
    Eigen::VectorXd spectrum(from_spectrum_.cols());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_fraction(from_spectrum_.cols(), n);
    appearance_.media_relative(fractions, {spectrum.data(), std::size_t(spectrum.size())},
                               {by_fraction.data(), std::size_t(by_fraction.size())});
    gradient = from_spectrum_ * by_fraction;
    return from_spectrum_ * spectrum;
}

}  // namespace voxtone::halftone
