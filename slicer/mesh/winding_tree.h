// SPDX-License-Identifier: GPL-3.0-or-later
//
// Winding numbers of a closed chain at many single points off the surface: signed crossings along rays parallel to the
// axes, two of three rays deciding; where rays run into edges, the sum of solid angles decides. Threads: const members
// may be called from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "voxtone/slicer/mesh/triangle_tree.h"

namespace voxtone::slicer {

class WindingTree {
public:
    /// Keeps references to both.
    WindingTree(std::span<const Eigen::Vector3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles)
        : tree_(positions, triangles), positions_(positions), triangles_(triangles) {}

    [[nodiscard]] int winding_number(const Eigen::Vector3d& p) const;

private:
    TriangleTree tree_;
    std::span<const Eigen::Vector3d> positions_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace voxtone::slicer
