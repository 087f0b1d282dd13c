// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_diagnosis.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_crossings.h"

namespace voxtone::slicer {

namespace {

long long crossing_pairs(const TriangleTree& tree, const Progress* progress, StepShare* bar) {
    WorkBudget work(WorkBudget::for_triangles(tree.triangles().size()), progress);
    try {
        return static_cast<long long>(count_crossings(tree, work, bar));
    } catch (const WorkExceeded&) {
        return -1;
    }
}

}  // namespace

MeshDiagnosis diagnose(const std::vector<Eigen::Vector3d>& positions,
                       const std::vector<std::array<std::uint32_t, 3>>& triangles, const TriangleTree* tree,
                       const Progress* progress, StepShare* bar) {
    MeshDiagnosis d;
    d.triangles = triangles.size();
    for_each_edge(edge_uses(triangles), [&](std::span<const EdgeUse> uses) {
        d.boundary_edges += uses.size() == 1;
        d.nonmanifold_edges += uses.size() > 2;
        d.inconsistent_edges += uses.size() == 2 && uses[0].sign == uses[1].sign;
        d.open_edges += edge_sum(uses) != 0;
    });
    std::vector<Triangle> proper = triangles;
    std::erase_if(proper, collapsed);
    d.shells = find_shells(proper).count;
    std::vector<Triangle> sorted = std::move(proper);
    for (Triangle& t : sorted) std::sort(t.begin(), t.end());
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t t = 1; t < sorted.size(); ++t) d.duplicate_faces += sorted[t] == sorted[t - 1];
    for (const Triangle& t : triangles) {
        const double a = area(positions, t);
        d.degenerate_faces += a == 0;
        d.area_mm2 += a;
        d.volume_mm3 += signed_volume(positions, t);
    }
    if (tree) d.crossing_pairs = crossing_pairs(*tree, progress, bar);
    return d;
}

}  // namespace voxtone::slicer
