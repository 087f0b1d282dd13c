// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether two bodies come near each other, or one lies in the other.
//
// Exact for the given doubles but for rounding: pairs of triangles whose boxes are near are measured (corner to face,
// edge to edge, and whether they cross); where no surface is near, a corner's winding number says whether one body is
// inside the other. Own code: CGAL 5 measures no two triangles in space, Embree's queries are for points.
#pragma once

#include <Eigen/Core>

#include "slicer/mesh/triangle_tree.h"

namespace voxtone::slicer {

/// True where a point of the body of `a` and one of the body of `b`, moved by `shift`, are nearer than `mm` > 0. Both
/// are closed chains. Time: by the triangles of either within the other's box and `mm` around it.
[[nodiscard]] bool nearer_than(const TriangleTree& a, const TriangleTree& b, const Eigen::Vector3d& shift, double mm);

/// Squared distance of the segments p0 p1 and q0 q1; they may be points.
[[nodiscard]] double squared_segment_distance(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1,
                                              const Eigen::Vector3d& q0, const Eigen::Vector3d& q1);

}  // namespace voxtone::slicer
