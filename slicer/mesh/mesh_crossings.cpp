// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/mesh/mesh_crossings.h"

#include <algorithm>
#include <span>
#include <utility>

#include "voxtone/slicer/mesh/exact_predicates.h"
#include "voxtone/slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

// visit(a, b) for each pair of triangles whose boxes meet, a < b.
template <class Visit>
void for_each_near_pair(const TriangleTree& tree, Visit&& visit) {
    std::vector<std::uint32_t> near;
    for (std::uint32_t t = 0; t < tree.triangles().size(); ++t) {
        const auto [a, b, c] = tree.corners(t);
        near.clear();
        tree.overlapping(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), near);
        for (const std::uint32_t other : near)
            if (other > t) visit(t, other);
    }
}

int common_corners(const Triangle& a, const Triangle& b) {
    int common = 0;
    for (const std::uint32_t v : a) common += std::count(b.begin(), b.end(), v) > 0;
    return common;
}

// The edge opposite to the one corner that t shares with `other`.
std::pair<std::uint32_t, std::uint32_t> far_edge(const Triangle& t, const Triangle& other) {
    int c = 0;
    while (std::count(other.begin(), other.end(), t[c]) == 0) ++c;
    return {t[(c + 1) % 3], t[(c + 2) % 3]};
}

}  // namespace

std::size_t count_crossings(const TriangleTree& tree) {
    const std::span<const Triangle> triangles = tree.triangles();
    std::size_t pairs = 0;
    for_each_near_pair(tree, [&](std::uint32_t a, std::uint32_t b) {
        if (common_corners(triangles[a], triangles[b]) == 0) pairs += triangles_meet(tree.corners(a), tree.corners(b));
    });
    return pairs;
}

std::vector<std::vector<std::uint32_t>> find_crossings(const TriangleTree& tree) {
    const std::span<const Vector3d> positions = tree.positions();
    const std::span<const Triangle> triangles = tree.triangles();
    std::vector<std::vector<std::uint32_t>> crossings(triangles.size());
    for_each_near_pair(tree, [&](std::uint32_t a, std::uint32_t b) {
        const Triangle &s = triangles[a], &t = triangles[b];
        const int common = common_corners(s, t);
        bool cross = false;
        if (common == 0) {
            cross = triangles_meet(tree.corners(a), tree.corners(b));
        } else if (common == 1) {
            const auto [p, q] = far_edge(s, t);
            const auto [u, v] = far_edge(t, s);
            cross = segment_meets_triangle(positions[p], positions[q], tree.corners(b)) ||
                    segment_meets_triangle(positions[u], positions[v], tree.corners(a));
        }
        if (!cross) return;
        crossings[a].push_back(b);
        crossings[b].push_back(a);
    });
    return crossings;
}

}  // namespace voxtone::slicer
