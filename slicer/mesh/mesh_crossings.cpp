// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_crossings.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "slicer/mesh/exact_predicates.h"
#include "slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

// visit(a, b) for each pair of triangles whose boxes meet, a < b; pairs with the same a come from one thread.
template <class Visit>
void for_each_near_pair(const TriangleTree& tree, WorkBudget& work, StepShare* bar, Visit&& visit) {
    parallel_ranges(0, tree.triangles().size(), 256, [&](std::size_t first, std::size_t last) {
        std::vector<std::uint32_t> near;
        for (auto t = static_cast<std::uint32_t>(first); t < last; ++t) {
            const auto [a, b, c] = tree.corners(t);
            near.clear();
            tree.overlapping(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), near);
            work.spend(near.size());
            for (const std::uint32_t other : near)
                if (other > t) visit(t, other);
        }
        if (bar) bar->advance(last - first);
    });
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

std::size_t count_crossings(const TriangleTree& tree, WorkBudget& work, StepShare* bar) {
    const std::span<const Triangle> triangles = tree.triangles();
    std::atomic<std::size_t> pairs = 0;
    for_each_near_pair(tree, work, bar, [&](std::uint32_t a, std::uint32_t b) {
        if (common_corners(triangles[a], triangles[b]) != 0) return;
        work.spend(WorkBudget::exact_test);
        pairs += triangles_meet(tree.corners(a), tree.corners(b));
    });
    return pairs;
}

std::vector<std::vector<std::uint32_t>> find_crossings(const TriangleTree& tree, WorkBudget& work, StepShare* bar) {
    const std::span<const Vector3d> positions = tree.positions();
    const std::span<const Triangle> triangles = tree.triangles();
    std::vector<std::vector<std::uint32_t>> crossings(triangles.size());
    for_each_near_pair(tree, work, bar, [&](std::uint32_t a, std::uint32_t b) {
        const Triangle &s = triangles[a], &t = triangles[b];
        const int common = common_corners(s, t);
        if (common > 1) return;
        work.spend(WorkBudget::exact_test);
        bool cross = false;
        if (common == 0) {
            cross = triangles_meet(tree.corners(a), tree.corners(b));
        } else {
            const auto [p, q] = far_edge(s, t);
            const auto [u, v] = far_edge(t, s);
            cross = segment_meets_triangle(positions[p], positions[q], tree.corners(b)) ||
                    segment_meets_triangle(positions[u], positions[v], tree.corners(a));
        }
        if (!cross) return;
        work.spend(WorkBudget::kept_pair);
        crossings[a].push_back(b);
    });
    // So far each pair is known at its lower triangle alone.
    std::vector<std::size_t> known(crossings.size());
    for (std::size_t t = 0; t < crossings.size(); ++t) {
        std::sort(crossings[t].begin(), crossings[t].end());
        known[t] = crossings[t].size();
    }
    for (std::uint32_t t = 0; t < crossings.size(); ++t)
        for (std::size_t n = 0; n < known[t]; ++n) crossings[crossings[t][n]].push_back(t);
    for (std::size_t t = 0; t < crossings.size(); ++t)
        std::rotate(crossings[t].begin(), crossings[t].begin() + std::ptrdiff_t(known[t]), crossings[t].end());
    return crossings;
}

}  // namespace voxtone::slicer
