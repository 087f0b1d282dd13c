// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/hole_filling.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <unordered_map>

#include <Eigen/Geometry>

#include "base/parallel.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

constexpr std::size_t cubic_limit = 200;

// Closed loops without repeated vertices that cancel the open edges.
std::vector<std::vector<std::uint32_t>> open_loops(std::span<const Triangle> triangles) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;  // directed so that they cancel what is there
    for_each_edge(edge_uses(triangles), [&](std::span<const EdgeUse> uses) {
        const int sum = edge_sum(uses);
        for (int n = 0; n < sum; ++n) arcs.emplace_back(uses[0].high, uses[0].low);
        for (int n = 0; n < -sum; ++n) arcs.emplace_back(uses[0].low, uses[0].high);
    });
    std::sort(arcs.begin(), arcs.end());
    std::unordered_map<std::uint32_t, std::size_t> first_arc;
    for (std::size_t a = arcs.size(); a-- > 0;) first_arc[arcs[a].first] = a;
    std::vector<bool> used(arcs.size(), false);

    // At every vertex as many arcs leave as arrive, so a walk can only end in a loop; a vertex met again closes one.
    std::vector<std::vector<std::uint32_t>> loops;
    std::unordered_map<std::uint32_t, std::size_t> place;  // of the path's vertices; emptied one by one, since to clear
    std::vector<std::uint32_t> path;                       // it takes as long as the longest path so far
    for (std::size_t a = 0; a < arcs.size(); ++a) {
        if (used[a]) continue;
        path.assign(1, arcs[a].first);
        place[arcs[a].first] = 0;
        while (!path.empty()) {
            std::size_t& next = first_arc[path.back()];
            while (next < arcs.size() && arcs[next].first == path.back() && used[next]) ++next;
            if (next == arcs.size() || arcs[next].first != path.back()) break;  // the start, with all its arcs used
            used[next] = true;
            const std::uint32_t vertex = arcs[next].second;
            const auto met = place.find(vertex);
            if (met == place.end()) {
                place[vertex] = path.size();
                path.push_back(vertex);
                continue;
            }
            std::vector<std::uint32_t> loop(path.begin() + std::ptrdiff_t(met->second), path.end());
            for (std::size_t n = met->second + 1; n < path.size(); ++n) place.erase(path[n]);
            path.resize(met->second + 1);
            if (loop.size() > 2) loops.push_back(std::move(loop));
        }
        for (const std::uint32_t vertex : path) place.erase(vertex);
    }
    return loops;
}

void fill_least_area(std::span<const Vector3d> positions, HoleFill& hole) {
    const std::size_t n = hole.loop.size();
    std::vector<double> cost(n * n, 0);
    std::vector<std::uint32_t> best(n * n, 0);
    for (std::size_t length = 2; length < n; ++length)
        for (std::size_t i = 0; i + length < n; ++i) {
            const std::size_t k = i + length;
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t j = i + 1; j < k; ++j) {
                const double c =
                    cost[i * n + j] + cost[j * n + k] + area(positions, {hole.loop[i], hole.loop[j], hole.loop[k]});
                if (c < least) {
                    least = c;
                    best[i * n + k] = static_cast<std::uint32_t>(j);
                }
            }
            cost[i * n + k] = least;
        }
    std::vector<std::pair<std::size_t, std::size_t>> stack{{0, n - 1}};
    while (!stack.empty()) {
        const auto [i, k] = stack.back();
        stack.pop_back();
        if (k < i + 2) continue;
        const std::size_t j = best[i * n + k];
        hole.triangles.push_back({hole.loop[i], hole.loop[j], hole.loop[k]});
        stack.emplace_back(i, j);
        stack.emplace_back(j, k);
    }
}

void fill_by_ears(std::span<const Vector3d> positions, HoleFill& hole) {
    const std::size_t n = hole.loop.size();
    std::vector<std::size_t> previous(n), next(n), version(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        previous[i] = (i + n - 1) % n;
        next[i] = (i + 1) % n;
    }
    Vector3d normal = Vector3d::Zero();  // of the loop as a whole (Newell)
    for (std::size_t i = 0; i < n; ++i) normal += positions[hole.loop[i]].cross(positions[hole.loop[next[i]]]);
    struct Ear {
        bool reflex;
        double length;
        std::size_t vertex, version;
        bool operator<(const Ear& o) const {  // the top of the queue is taken first
            return reflex != o.reflex ? reflex : length != o.length ? length > o.length : vertex > o.vertex;
        }
    };
    std::priority_queue<Ear> ears;
    const auto push = [&](std::size_t i) {
        const Vector3d &a = positions[hole.loop[previous[i]]], &b = positions[hole.loop[i]],
                       &c = positions[hole.loop[next[i]]];
        ears.push({(b - a).cross(c - b).dot(normal) <= 0, (c - a).norm(), i, ++version[i]});
    };
    for (std::size_t i = 0; i < n; ++i) push(i);
    for (std::size_t left = n; left > 2;) {
        const Ear ear = ears.top();
        ears.pop();
        if (ear.version != version[ear.vertex]) continue;
        const std::size_t i = ear.vertex, p = previous[i], q = next[i];
        hole.triangles.push_back({hole.loop[p], hole.loop[i], hole.loop[q]});
        next[p] = q;
        previous[q] = p;
        version[i] = 0;  // never again: versions in the queue start at 1
        --left;
        push(p);
        push(q);
    }
}

}  // namespace

std::vector<HoleFill> fill_holes(std::span<const Vector3d> positions, std::span<const Triangle> triangles,
                                 const Progress* progress) {
    std::vector<HoleFill> fills;
    for (auto& loop : open_loops(triangles)) fills.emplace_back().loop = std::move(loop);
    parallel_for(
        0, fills.size(), 1,
        [&](std::size_t f) {
            if (fills[f].loop.size() <= cubic_limit)
                fill_least_area(positions, fills[f]);
            else
                fill_by_ears(positions, fills[f]);
        },
        progress);
    return fills;
}

}  // namespace voxtone::slicer
