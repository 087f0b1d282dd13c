// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface that encloses the body, ready for the printer's grid: in mm, welded, oriented outward, and closed as a
// chain: along every edge the faces that run it one way are as many as those that run it the other way. Self-crossing
// and non-manifold chains are welcome; the winding number is defined for them too.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

struct SolidMesh {
    std::vector<Eigen::Vector3d> positions_mm;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// Per triangle the triangle of the textured mesh that it comes from (its corners may be in another order), or -1
    /// where it was made by the repair.
    std::vector<std::int32_t> source_triangle;
};

}  // namespace voxtone::slicer
