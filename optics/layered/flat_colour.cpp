// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/flat_colour.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "base/contracts.h"
#include "optics/colour/channels.h"
#include "optics/colour/colour.h"

namespace voxtone::optics {

namespace {

constexpr double knee = 6.0 / 29;  // CIE 15:2018, 8.2.1
constexpr double largest_ratio = 2;

Eigen::Matrix3Xd xyz_of_channels(const Channels& channels) {
    if (!channels.is_own()) return d65_weights(channels);
    Eigen::Matrix3Xd weights(3, static_cast<Eigen::Index>(channels.size()));
    for (std::size_t c = 0; c < channels.size(); ++c)
        weights.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::Vector3d>(channels.xyz[c].data());
    return weights;
}

}  // namespace

Eigen::Vector3d lab_roots(const Eigen::Vector3d& xyz, const Eigen::Vector3d& white) {
    return xyz.cwiseQuotient(white).unaryExpr(
        [](double t) { return t > knee * knee * knee ? std::cbrt(t) : t / (3 * knee * knee) + 4.0 / 29; });
}

Eigen::Vector3d xyz_of_roots(const Eigen::Vector3d& roots, const Eigen::Vector3d& white) {
    return roots.unaryExpr([](double f) { return f > knee ? f * f * f : 3 * knee * knee * (f - 4.0 / 29); })
        .cwiseProduct(white);
}

FlatColour::FlatColour(const ResinSet& set, const std::array<double, 3>& pitch_mm)
    : medium_(set, pitch_mm),
      reflectance_(set.g, set.eta, set.measured.geometry),
      residual_(set.residual),
      measured_(set.measured),
      weights_(xyz_of_channels(set.channels)),
      white_(set.channels.is_own() ? colorimetric_white(set.channels.illuminant) : d65_white()),
      to_rgb_(linear_srgb_of(white_)),
      from_rgb_(to_rgb_.inverse()) {}

std::vector<double> FlatColour::reading(std::span<const double> shares) const {
    std::vector<double> rho(static_cast<std::size_t>(weights_.cols()));
    for (std::size_t c = 0; c < rho.size(); ++c)
        rho[c] = measured_.gain * (measured_.surface + reflectance_(medium_(shares, c)));
    return rho;
}

Eigen::Vector3d FlatColour::physics(std::span<const double> shares) const {
    const std::vector<double> rho = reading(shares);
    return weights_ * Eigen::Map<const Eigen::VectorXd>(rho.data(), weights_.cols());
}

Eigen::Vector3d FlatColour::xyz(std::span<const double> shares) const {
    const Eigen::Vector3d plain = physics(shares);
    if (!corrects()) return plain;
    return xyz_of_roots(lab_roots(plain, white_) + residual_(shares), white_);
}

Eigen::Vector3d FlatColour::lab(std::span<const double> shares) const { return lab_from_xyz(xyz(shares), white_); }

Eigen::Vector3d FlatColour::ratio(std::span<const double> shares) const {
    if (!corrects()) return Eigen::Vector3d::Ones();
    const Eigen::Vector3d plain = physics(shares);
    const Eigen::Vector3d corrected = xyz_of_roots(lab_roots(plain, white_) + residual_(shares), white_);
    Eigen::Vector3d ratio;
    for (Eigen::Index k = 0; k < 3; ++k)
        ratio[k] = plain[k] > 0 ? std::clamp(corrected[k] / plain[k], 1 / largest_ratio, largest_ratio) : 1;
    return ratio;
}

Eigen::Matrix3d FlatColour::correction(std::span<const double> shares) const {
    if (!corrects()) return Eigen::Matrix3d::Identity();
    return to_rgb_ * ratio(shares).asDiagonal() * from_rgb_;
}

}  // namespace voxtone::optics
