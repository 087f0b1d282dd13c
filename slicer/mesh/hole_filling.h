// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangles that close an open mesh, on the vertices that are there. The edges that do not cancel form closed loops,
// whatever the mesh; each loop is filled, so that the result is a closed chain always.
//
// Loops of up to 200 vertices get the triangulation of least area (G. Barequet, M. Sharir, "Filling gaps in the
// boundary of a polyhedron", 1995; cubic time), longer ones are closed ear by ear, the ear with the shortest new edge
// first. Own code because CGAL's triangulate_hole walks the one border that a manifold mesh has at each corner; loops
// that touch or cross in a corner, and edges that are open by more than one face, it cannot be given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

/// One filled loop.
struct HoleFill {
    std::vector<std::uint32_t> loop;  ///< vertices, in the direction of the fill
    std::vector<Triangle> triangles;
};

[[nodiscard]] std::vector<HoleFill> fill_holes(std::span<const Eigen::Vector3d> positions,
                                               std::span<const Triangle> triangles, const Progress* progress = nullptr);

}  // namespace voxtone::slicer
