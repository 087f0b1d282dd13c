// SPDX-License-Identifier: GPL-3.0-or-later
//
// Features thinner than a voxel, which hold no voxel centre or only some, do not vanish: the solid with the voxels that
// they need added.
//
// Plates: where a grid line through voxel centres (along x, y or z) enters and leaves the body between two neighbouring
// centres, both outside, through faces that face away from each other (by more than 120 degrees: a ridge of a thick
// body is no plate), the voxel that holds the middle is added. The voxels of a plate of any angle are then connected.
// Wires and tips, thin in two directions or three, are followed along the edges of the mesh (no point of such a feature
// is far from one): for each two voxels that an edge passes in turn, the voxels about them (the 26 around each and they
// themselves) must hold body, all connected; else the two are added. Where they hold body in several parts this is
// done only if the surface at that edge is thin (it is left again within a voxel's diagonal), so that gaps between
// bodies stay.
//
// Each rule looks at most three layers away, so the result is the same for every split into slabs.
// Threads: const members may be called from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "slicer/mesh/spatial_index.h"
#include "slicer/solid/solid.h"

namespace voxtone::slicer {

class ThinFeatures {
public:
    /// Keeps references to both, `solid` made of `mesh`.
    ThinFeatures(const SolidIndex& mesh, const Solid& solid);

    /// The layers [k_begin, k_end) of the solid with what is added; returns how many voxels were.
    std::uint64_t slab(int k_begin, int k_end, SpanSlab& out) const;

private:
    struct Edge {
        std::array<std::uint32_t, 2> corner;
        Eigen::Vector3f inward;  // unit, or zero where the faces fold back upon themselves
    };

    [[nodiscard]] Eigen::Vector3d normal(std::uint32_t triangle) const;
    [[nodiscard]] bool thin_at(const Edge& edge, const Eigen::Vector3d& p_mm) const;

    const SolidMesh& mesh_;
    const Solid& solid_;
    const TriangleTree& tree_;
    std::vector<Edge> edges_;
    std::vector<std::size_t> bucket_begin_;  // edges by bucket of layers
    std::vector<std::uint32_t> bucket_edges_;
};

}  // namespace voxtone::slicer
