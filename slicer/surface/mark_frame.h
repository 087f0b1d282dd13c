// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a mark lies: a rectangle in space, above the surface that it is projected onto.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace voxtone::slicer {

/// Unit vectors, right x up = out, which points to who reads it.
struct MarkAxes {
    Eigen::Vector3d right = Eigen::Vector3d::UnitX(), up = Eigen::Vector3d::UnitY(), out = Eigen::Vector3d::UnitZ();

    /// Anticlockwise for who reads it.
    [[nodiscard]] MarkAxes turned(double degrees) const {
        const Eigen::AngleAxisd turn(degrees * (EIGEN_PI / 180), out);
        return {turn * right, turn * up, out};
    }
};

/// Upright for who stands before it: up is +z, or +y where it lies on its back and -y where it lies on its face.
[[nodiscard]] inline MarkAxes axes_facing(const Eigen::Vector3d& out) {
    const Eigen::Vector3d n = out.normalized();
    constexpr double lying = 0.999;
    const Eigen::Vector3d wanted =
        std::abs(n.z()) < lying ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(0, n.z() > 0 ? 1 : -1, 0);
    const Eigen::Vector3d up = (wanted - wanted.dot(n) * n).normalized();
    return {up.cross(n), up, n};
}

struct MarkFrame {
    MarkAxes axes;
    Eigen::Vector3d corner_mm = Eigen::Vector3d::Zero();  ///< lower left
    double width_mm = 0, height_mm = 0;

    [[nodiscard]] static MarkFrame around(const Eigen::Vector3d& middle, const MarkAxes& axes, double width_mm,
                                          double height_mm) {
        return {axes, middle - axes.right * (width_mm / 2) - axes.up * (height_mm / 2), width_mm, height_mm};
    }
    [[nodiscard]] Eigen::Vector3d at(double along_mm, double up_mm, double depth_mm = 0) const {
        return corner_mm + axes.right * along_mm + axes.up * up_mm - axes.out * depth_mm;
    }
};

}  // namespace voxtone::slicer
