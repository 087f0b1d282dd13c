// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "voxtone/slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

/// Pairs of triangles without a common corner that meet: crossing, touching, or lying in each other (exact predicates).
/// Triangles without area are left out.
[[nodiscard]] std::size_t count_crossings(std::span<const Eigen::Vector3d> positions,
                                          std::span<const Triangle> triangles);

/// Per triangle the triangles that it crosses or touches other than in the corners they share: those of the pairs
/// above, and those with one common corner that meet beyond it.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> find_crossings(std::span<const Eigen::Vector3d> positions,
                                                                     std::span<const Triangle> triangles);

}  // namespace voxtone::slicer
