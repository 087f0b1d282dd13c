// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scenes/fbx_transform.h"

#include <array>
#include <cmath>
#include <numbers>

namespace voxtone::io {

namespace {

Eigen::Matrix3d turn_about(Eigen::Index axis, double degrees) {
    constexpr double rounding = 1e-5;
    const double quarters = std::round(degrees / 90), radians = degrees * std::numbers::pi / 180;
    double c = std::cos(radians), s = std::sin(radians);
    if (std::abs(degrees - 90 * quarters) < rounding) {
        const int quarter = static_cast<int>(quarters - 4 * std::floor(quarters / 4));
        c = std::array{1, 0, -1, 0}[static_cast<std::size_t>(quarter % 4)];
        s = std::array{0, 1, 0, -1}[static_cast<std::size_t>(quarter % 4)];
    }
    const Eigen::Index next = (axis + 1) % 3, last = (axis + 2) % 3;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn(next, next) = turn(last, last) = c;
    turn(last, next) = s;
    turn(next, last) = -s;
    return turn;
}

Eigen::Translation3d moved(const Eigen::Vector3d& by) { return Eigen::Translation3d(by); }

}  // namespace

Eigen::Matrix3d fbx_rotation(const Eigen::Vector3d& degrees, int order) {
    constexpr std::array<std::array<Eigen::Index, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}}};
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    if (!degrees.allFinite()) return rotation;
    for (const Eigen::Index axis : orders[order >= 0 && order < 6 ? static_cast<std::size_t>(order) : 0])
        rotation = turn_about(axis, degrees[axis]) * rotation;
    return rotation;
}

FbxPlace place_below(const FbxPlace& parent, const FbxLocalTransform& local) {
    const Eigen::Matrix3d turn = fbx_rotation(local.pre_rotation) * fbx_rotation(local.rotation, local.rotation_order) *
                                 fbx_rotation(local.post_rotation).transpose();
    const Eigen::Affine3d here = moved(local.translation) * moved(local.rotation_offset) * moved(local.rotation_pivot) *
                                 Eigen::Affine3d(turn) * moved(-local.rotation_pivot) * moved(local.scaling_offset) *
                                 moved(local.scaling_pivot) * Eigen::Scaling(local.scaling) *
                                 moved(-local.scaling_pivot);
    FbxPlace place;
    place.own_scaling = local.scaling;
    place.rotation = parent.rotation * turn;
    place.transform = parent.transform * here;
    // Its origin is where products of matrices put it, however scale goes on.
    Eigen::Matrix3d scale_above = parent.rotation.transpose() * parent.transform.linear();
    if (local.inherit == 2) {
        if (parent.own_scaling.cwiseAbs().minCoeff() > 0)
            scale_above = scale_above * parent.own_scaling.cwiseInverse().asDiagonal();
    }
    if (local.inherit == 0 || local.inherit == 2)
        place.transform.linear() = parent.rotation * turn * scale_above * Eigen::Matrix3d(local.scaling.asDiagonal());
    return place;
}

}  // namespace voxtone::io
