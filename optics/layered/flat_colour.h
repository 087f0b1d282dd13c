// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour of a thick, flat piece of one mixture as an instrument reads it, by a set's physics and with its residual:
//
//   XYZ_physics(f) = gain sum_c w_c (surface + rho(medium_c(f))),   f(XYZ / white) += residual(f)  ->  XYZ(f)
//
// rho: half_space_reflectance.h. What a place of a print shows is corrected by the ratio of both for the mixture that
// light sees there, component by component of XYZ. Ratios are kept in [1/2, 2], which measured mixtures never reach:
// nothing that is wrong in a set may turn a colour over.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "optics/layered/half_space_reflectance.h"
#include "optics/media/effective_medium.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

class FlatColour {
public:
    /// `pitch_mm`: of the voxels of a halftone; 0: ideal mixtures.
    explicit FlatColour(const ResinSet& set, const std::array<double, 3>& pitch_mm = {});

    /// Of the illuminant of the set's channels, under which the XYZ below are.
    [[nodiscard]] const Eigen::Vector3d& white() const { return white_; }
    [[nodiscard]] Eigen::Vector3d physics(std::span<const double> shares) const;
    [[nodiscard]] Eigen::Vector3d xyz(std::span<const double> shares) const;
    [[nodiscard]] Eigen::Vector3d lab(std::span<const double> shares) const;
    /// xyz / physics; (1, 1, 1) without a residual.
    [[nodiscard]] Eigen::Vector3d ratio(std::span<const double> shares) const;
    [[nodiscard]] bool corrects() const { return !residual_.empty(); }
    /// The same for linear sRGB: correction(shares) * rgb is rgb with its XYZ times `ratio`; the identity without a
    /// residual.
    [[nodiscard]] Eigen::Matrix3d correction(std::span<const double> shares) const;

    /// rho per channel, gain and surface included: what a check compares.
    [[nodiscard]] std::vector<double> reading(std::span<const double> shares) const;

private:
    EffectiveMedium medium_;
    HalfSpaceReflectance reflectance_;
    ColourResidual residual_;
    FlatMeasurement measured_;
    Eigen::Matrix3Xd weights_;
    Eigen::Vector3d white_;
    Eigen::Matrix3d to_rgb_, from_rgb_;  ///< linear sRGB of XYZ under `white_`, and back
};

/// CIELAB's f of XYZ / white, and back: straight below (6/29)^3, so that negative values keep their sign.
[[nodiscard]] Eigen::Vector3d lab_roots(const Eigen::Vector3d& xyz, const Eigen::Vector3d& white);
[[nodiscard]] Eigen::Vector3d xyz_of_roots(const Eigen::Vector3d& roots, const Eigen::Vector3d& white);

}  // namespace voxtone::optics
