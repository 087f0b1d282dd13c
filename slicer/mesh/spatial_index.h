// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh with the one tree over it that all who search in it share. Made once and handed on by reference; the mesh can
// be looked at like through a pointer and does not change any more.
//
// Not copied: a copy of the tree would go on looking at the mesh that it was built over. Moving is fine, since a moved
// vector keeps its elements where they are. Threads: const members may be called from any thread.
#pragma once

#include <utility>

#include "slicer/mesh/solid_mesh.h"
#include "slicer/mesh/triangle_tree.h"

namespace voxtone::slicer {

/// `Mesh` has vectors `positions_mm` and `triangles`.
template <class Mesh>
class SpatialIndex {
public:
    SpatialIndex() : SpatialIndex(Mesh{}) {}
    explicit SpatialIndex(Mesh mesh) : mesh_(std::move(mesh)), tree_(mesh_.positions_mm, mesh_.triangles) {}

    [[nodiscard]] const Mesh& operator*() const { return mesh_; }
    [[nodiscard]] const Mesh* operator->() const { return &mesh_; }
    [[nodiscard]] const TriangleTree& tree() const { return tree_; }

private:
    Mesh mesh_;
    TriangleTree tree_;
};

using SolidIndex = SpatialIndex<SolidMesh>;

}  // namespace voxtone::slicer
