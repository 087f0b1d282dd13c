// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "voxtone/slicer/mesh_chain.h"

namespace voxtone::slicer {

/// Pairs of triangles without a common corner that meet: crossing, touching, or lying in each other (exact predicates).
/// Triangles without area are left out.
[[nodiscard]] std::size_t count_crossings(std::span<const Eigen::Vector3d> positions, std::span<const Triangle> triangles);

}  // namespace voxtone::slicer
