// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh in numbers: what keeps it from being closed as a chain (open_edges == 0), and what is unusual about it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/step_share.h"
#include "slicer/mesh/triangle_tree.h"

namespace voxtone::slicer {

/// Edges are undirected; a shell is what is joined through edges.
struct MeshDiagnosis {
    std::size_t triangles = 0;
    std::size_t boundary_edges = 0;      ///< with one face
    std::size_t nonmanifold_edges = 0;   ///< with more than two
    std::size_t inconsistent_edges = 0;  ///< with two faces that run them the same way
    std::size_t open_edges = 0;          ///< whose faces do not cancel: where the surface does not enclose
    std::size_t degenerate_faces = 0;    ///< without area
    std::size_t duplicate_faces = 0;     ///< with the same corners as an earlier one
    std::size_t shells = 0;
    long long crossing_pairs = -1;  ///< of triangles without a common corner; -1: not counted, or too many to count
    double area_mm2 = 0;
    double volume_mm3 = 0;  ///< signed; of closed meshes only a volume

    friend bool operator==(const MeshDiagnosis&, const MeshDiagnosis&) = default;
};

/// `tree`: over this mesh, to count crossings with; null: they are not counted. `bar` advances by a task a
/// triangle while they are.
[[nodiscard]] MeshDiagnosis diagnose(const std::vector<Eigen::Vector3d>& positions,
                                     const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                     const TriangleTree* tree = nullptr, const Progress* progress = nullptr,
                                     StepShare* bar = nullptr);

}  // namespace voxtone::slicer
