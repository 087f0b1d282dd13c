// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh on the lattice of a voxel grid: vertices rounded to 2^-16 voxel (coarser for meshes above 16384 voxels along
// an axis, so that all products fit 64 bits), with whole numbers at voxel centres; triangles found by layer. Not for
// use outside the solid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slicer/mesh/solid_mesh.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

// Smallest integer >= n / d, for d > 0.
template <class Int>
constexpr Int ceil_div(Int n, Int d) {
    const Int q = n / d;
    return q * d < n ? q + 1 : q;
}

struct FixedMesh {
    using Vertex = std::array<std::int32_t, 3>;  // differences below 2^30

    /// Mesh and grid together below 2^22 voxels along each axis.
    FixedMesh(const SolidMesh& mesh, const VoxelGrid& grid);

    int fraction_bits = 16;
    std::vector<Vertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;

    /// Calls visit(triangle, first layer, past the last) for pieces of [k_begin, k_end), each triangle that meets the
    /// layers of a piece or the space up to the next layers once per piece. Layers outside of the grid have no
    /// triangles.
    template <class Visit>
    void for_each_triangle(int k_begin, int k_end, Visit&& visit) const {
        for (int k = k_begin; k < k_end;) {
            const std::size_t bucket = std::size_t(k / bucket_layers);
            const int end = k_end < int(bucket + 1) * bucket_layers ? k_end : int(bucket + 1) * bucket_layers;
            for (std::size_t n = bucket_begin[bucket]; n < bucket_begin[bucket + 1]; ++n)
                visit(bucket_triangles[n], k, end);
            k = end;
        }
    }

    static constexpr int bucket_layers = 16;
    std::vector<std::size_t> bucket_begin;
    std::vector<std::uint32_t> bucket_triangles;
};

}  // namespace voxtone::slicer
