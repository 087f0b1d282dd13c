// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include <Eigen/Core>

namespace voxtone::slicer {

/// True where two closed triangles have a point in common (exact for the given doubles). False if one has no area.
[[nodiscard]] bool triangles_meet(const std::array<Eigen::Vector3d, 3>& a, const std::array<Eigen::Vector3d, 3>& b);

/// True where the closed segment pq and the closed triangle have a point in common (exact). False without length or
/// area.
[[nodiscard]] bool segment_meets_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                          const std::array<Eigen::Vector3d, 3>& t);

}  // namespace voxtone::slicer
