// SPDX-License-Identifier: GPL-3.0-or-later
//
// The coloured surface: triangles from which colour is taken and depth is measured. Each knows which triangle of the
// textured mesh it lies on, and where.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

struct VisibleSurface {
    std::vector<Eigen::Vector3d> positions_mm;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// Per triangle its triangle of the textured mesh.
    std::vector<std::uint32_t> source_triangle;
    /// Per triangle and corner the place in the source triangle: weights (u, v) of the source's corners 1 and 2; corner 0
    /// has the rest, 1 - u - v.
    std::vector<std::array<Eigen::Vector2f, 3>> source_uv;
};

}  // namespace voxtone::slicer
