// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where points of a flat thing lie in its photograph: a homography, as a pinhole camera without distortion makes it.
// Pixels: the middle of the first pixel is at (0.5, 0.5), y down.
#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace voxtone::calibration {

class Rectification {
public:
    Rectification() = default;
    explicit Rectification(const Eigen::Matrix3d& to_px) : to_px_(to_px), from_px_(to_px.inverse()) {}

    /// Least squares over four or more pairs. `residual_px`: root mean square of what is left.
    [[nodiscard]] static Rectification fit(std::span<const Eigen::Vector2d> plane, std::span<const Eigen::Vector2d> px,
                                           double* residual_px = nullptr);

    [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& p) const {
        return (to_px_ * p.homogeneous()).hnormalized();
    }
    [[nodiscard]] Eigen::Vector2d from_px(const Eigen::Vector2d& px) const {
        return (from_px_ * px.homogeneous()).hnormalized();
    }
    /// Pixels per unit of the plane around a point: the square root of the change of area.
    [[nodiscard]] double px_per_unit(const Eigen::Vector2d& p) const;
    /// The plane is seen from its back (y up in the plane, down in the picture, makes the seen front negative).
    [[nodiscard]] bool seen_from_back(const Eigen::Vector2d& p) const;

private:
    [[nodiscard]] double area_change(const Eigen::Vector2d& p) const;
    Eigen::Matrix3d to_px_ = Eigen::Matrix3d::Identity(), from_px_ = Eigen::Matrix3d::Identity();
};

}  // namespace voxtone::calibration
