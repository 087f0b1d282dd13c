// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_chain.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Geometry>

#include "slicer/mesh/disjoint_sets.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

std::vector<EdgeUse> edge_uses(std::span<const Triangle> triangles) {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (collapsed(triangles[t])) continue;
        for (int e = 0; e < 3; ++e) {
            const std::uint32_t from = triangles[t][e], to = triangles[t][(e + 1) % 3];
            uses.push_back({std::min(from, to), std::max(from, to), t, from < to ? 1 : -1});
        }
    }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return a.low != b.low             ? a.low < b.low
               : a.high != b.high         ? a.high < b.high
               : a.triangle != b.triangle ? a.triangle < b.triangle
                                          : a.sign < b.sign;
    });
    return uses;
}

std::size_t open_edges(std::span<const Triangle> triangles) {
    std::size_t open = 0;
    for_each_edge(edge_uses(triangles), [&](std::span<const EdgeUse> uses) { open += edge_sum(uses) != 0; });
    return open;
}

Shells find_shells(std::span<const Triangle> triangles) {
    DisjointSets sets(triangles.size());
    const std::vector<EdgeUse> uses = edge_uses(triangles);
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() == 2) sets.unite(edge[0].triangle, edge[1].triangle);
    });
    // Where more faces meet, those that cancel within their own shell part there; the rest needs each other.
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() <= 2) return;
        std::map<std::uint32_t, int> sum;
        for (const EdgeUse& u : edge) sum[sets.root(u.triangle)] += u.sign;
        std::erase_if(sum, [](const auto& s) { return s.second == 0; });
        for (const auto& s : sum) sets.unite(sum.begin()->first, s.first);
    });
    Shells shells;
    shells.of_triangle.resize(triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {  // a root is the lowest triangle of its shell
        const std::uint32_t r = sets.root(t);
        shells.of_triangle[t] = r == t ? shells.count++ : shells.of_triangle[r];
    }
    return shells;
}

double signed_volume(std::span<const Vector3d> positions, const Triangle& t) {
    return positions[t[0]].dot(positions[t[1]].cross(positions[t[2]])) / 6;
}

double area(std::span<const Vector3d> positions, const Triangle& t) {
    return (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]).norm() / 2;
}

double winding_number(std::span<const Vector3d> positions, std::span<const Triangle> triangles, const Vector3d& p) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const Vector3d a = positions[t[0]] - p, b = positions[t[1]] - p, c = positions[t[2]] - p;
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum / (2 * std::numbers::pi);
}

}  // namespace voxtone::slicer
