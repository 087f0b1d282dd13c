// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a node of an FBX scene stands (Autodesk, "FBX SDK Programmer's Guide", Computing transformation matrices):
//   T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1
// below its parent, whose scale it inherits in one of three ways. Angles are degrees, about x, y, z one after the
// other; those within a hundred-thousandth of a quarter turn, as floats round them, are that.
#pragma once

#include <Eigen/Geometry>

namespace voxtone::io {

struct FbxLocalTransform {
    Eigen::Vector3d translation = Eigen::Vector3d::Zero(), rotation = Eigen::Vector3d::Zero(),
                    scaling = Eigen::Vector3d::Ones();
    Eigen::Vector3d pre_rotation = Eigen::Vector3d::Zero(), post_rotation = Eigen::Vector3d::Zero(),
                    rotation_offset = Eigen::Vector3d::Zero(), rotation_pivot = Eigen::Vector3d::Zero(),
                    scaling_offset = Eigen::Vector3d::Zero(), scaling_pivot = Eigen::Vector3d::Zero();
    int rotation_order = 0;  ///< XYZ XZY YZX YXZ ZXY ZYX, the first turns first; others count as the first
    int inherit = 1;         ///< of the parent's scale: 0 RrSs, 1 RSrs (products of matrices), 2 Rrs (none of its own)
};

/// A node in its scene.
struct FbxPlace {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< of it and all above it, without scale
    Eigen::Vector3d own_scaling = Eigen::Vector3d::Ones();
};

[[nodiscard]] FbxPlace place_below(const FbxPlace& parent, const FbxLocalTransform& local);

/// R of angles in an order.
[[nodiscard]] Eigen::Matrix3d fbx_rotation(const Eigen::Vector3d& degrees, int order = 0);

}  // namespace voxtone::io
