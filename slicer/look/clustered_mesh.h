// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh with fewer vertices: those that fall into the same cube and look the same way become one, in their mean.
//
// Method: vertex clustering (J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex
// scenes", 1993), with the axis that a vertex's normal is nearest to as part of the key, so that the two sides of a
// thin wall stay apart. Triangles whose corners fall together are left out; neighbours stay joined. Cubes are as small
// as the number of vertices allows, in steps of a quarter. Error: half a cube's diagonal.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

struct ClusteredMesh {
    std::vector<Eigen::Vector3f> positions_mm;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> vertex_of;  ///< for each vertex as it was
    double cube_mm = 0;                    ///< 0: nothing fell together
};

/// `finest_mm`: how far apart the vertices are.
[[nodiscard]] ClusteredMesh clustered(std::span<const Eigen::Vector3f> positions_mm,
                                      std::span<const std::array<std::uint32_t, 3>> triangles,
                                      std::size_t most_vertices, double finest_mm);

}  // namespace voxtone::slicer
