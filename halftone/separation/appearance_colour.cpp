// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/appearance_colour.h"

#include <fmt/core.h>

#include "base/error.h"
#include "optics/colour/observed_colour.h"

namespace voxtone::halftone {

AppearanceColour::AppearanceColour(const optics::ShellAppearance& appearance, const optics::Channels& channels)
    : appearance_(appearance) {
    if (appearance.channels() != channels.size())
        throw InputError(
            fmt::format("colour separation was told of {} channels, but the resin set has {}: what colour they are is "
                        "unknown; give the channels of the set",
                        channels.size(), appearance.channels()));
    if (!appearance.set().residual.empty()) correction_.emplace(appearance.set(), appearance.geometry().white());
    if (channels.is_rgb()) return;
    from_channels_ = optics::ObservedColour<double>(channels).relative_weights(appearance.white_appearance().data());
}

Eigen::Vector3d AppearanceColour::physics(std::span<const double> fractions) const {
    Eigen::Vector3d colour;
    if (from_channels_.size() == 0) {
        appearance_.media_relative(fractions, {colour.data(), 3});
        return colour;
    }
    Eigen::VectorXd value(from_channels_.cols());
    appearance_.appearance(fractions, {value.data(), std::size_t(value.size())});
    return from_channels_ * value;
}

Eigen::Vector3d AppearanceColour::physics(std::span<const double> fractions, Gradient& gradient) const {
    const auto n = static_cast<Eigen::Index>(fractions.size());
    gradient.resize(3, n);
    Eigen::Vector3d colour;
    if (from_channels_.size() == 0) {
        appearance_.media_relative(fractions, {colour.data(), 3}, {gradient.data(), std::size_t(3 * n)});
        return colour;
    }
    Eigen::VectorXd value(from_channels_.cols());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_fraction(from_channels_.cols(), n);
    appearance_.appearance(fractions, {value.data(), std::size_t(value.size())},
                           {by_fraction.data(), std::size_t(by_fraction.size())});
    gradient = from_channels_ * by_fraction;
    return from_channels_ * value;
}

Eigen::Vector3d AppearanceColour::rgb(std::span<const double> fractions) const {
    if (!correction_) return physics(fractions);
    return correction_->of(fractions) * physics(fractions);
}

Eigen::Vector3d AppearanceColour::rgb(std::span<const double> fractions, Gradient& gradient) const {
    const Eigen::Vector3d plain = physics(fractions, gradient);
    if (!correction_) return plain;
    const Eigen::Matrix3d correction = correction_->of(fractions);
    gradient = (correction * gradient).eval();
    return correction * plain;
}

}  // namespace voxtone::halftone
