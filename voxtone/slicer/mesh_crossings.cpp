// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/mesh_crossings.h"

#include <algorithm>

#include "voxtone/slicer/exact_predicates.h"
#include "voxtone/slicer/triangle_tree.h"

namespace voxtone::slicer {

std::size_t count_crossings(std::span<const Eigen::Vector3d> positions, std::span<const Triangle> triangles) {
    const TriangleTree tree(positions, triangles);
    std::size_t pairs = 0;
    std::vector<std::uint32_t> near;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const auto corners = tree.corners(t);
        near.clear();
        tree.overlapping(corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]), corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]), near);
        for (const std::uint32_t other : near) {
            if (other <= t) continue;
            const Triangle &m = triangles[t], &o = triangles[other];
            if (std::find_first_of(m.begin(), m.end(), o.begin(), o.end()) != m.end()) continue;
            pairs += triangles_meet(corners, tree.corners(other));
        }
    }
    return pairs;
}

}  // namespace voxtone::slicer
