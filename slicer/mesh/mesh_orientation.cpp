// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/mesh/mesh_orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include <Eigen/Geometry>

namespace voxtone::slicer {

using Eigen::Vector3d;

std::size_t orient_consistently(std::span<Triangle> triangles) {
    const std::vector<EdgeUse> uses = edge_uses(triangles);
    // Neighbours through edges of exactly two faces; `same` where both run the edge the same way.
    struct Link {
        std::uint32_t from, to;
        bool same;
    };
    std::vector<Link> links;
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) return;
        const bool same = edge[0].sign == edge[1].sign;
        links.push_back({edge[0].triangle, edge[1].triangle, same});
        links.push_back({edge[1].triangle, edge[0].triangle, same});
    });
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.from < b.from; });
    std::vector<std::size_t> first(triangles.size() + 1, 0);
    for (const Link& l : links) ++first[l.from + 1];
    for (std::size_t t = 0; t < triangles.size(); ++t) first[t + 1] += first[t];

    std::vector<std::int8_t> turn(triangles.size(), -1);
    std::vector<std::uint32_t> patch(triangles.size(), 0), queue;
    std::uint32_t patches = 0;
    for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
        if (turn[seed] >= 0) continue;
        queue.assign(1, seed);
        turn[seed] = 0;
        std::size_t turned = 0;
        for (std::size_t n = 0; n < queue.size(); ++n) {
            const std::uint32_t t = queue[n];
            patch[t] = patches;
            turned += turn[t] != 0;
            for (std::size_t l = first[t]; l < first[t + 1]; ++l) {
                if (turn[links[l].to] >= 0) continue;
                turn[links[l].to] = turn[t] != links[l].same;
                queue.push_back(links[l].to);
            }
        }
        if (2 * turned > queue.size())
            for (const std::uint32_t t : queue) turn[t] = !turn[t];
        ++patches;
    }

    // Edges where more faces meet: each as the sum over its patches. A patch is turned while that closes more than it
    // opens.
    struct Junction {
        std::map<std::uint32_t, int> sum_of_patch;
        [[nodiscard]] int sum() const {
            int s = 0;
            for (const auto& [p, n] : sum_of_patch) s += n;
            return s;
        }
    };
    std::vector<Junction> junctions;
    std::map<std::uint32_t, std::vector<std::size_t>> junctions_of_patch;
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() <= 2) return;
        Junction junction;
        for (const EdgeUse& u : edge) junction.sum_of_patch[patch[u.triangle]] += turn[u.triangle] ? -u.sign : u.sign;
        for (const auto& [p, n] : junction.sum_of_patch)
            if (n != 0) junctions_of_patch[p].push_back(junctions.size());
        junctions.push_back(std::move(junction));
    });
    std::vector<bool> turn_patch(patches, false);
    for (int round = 0; round < 20; ++round) {
        bool changed = false;
        for (const auto& [p, edges] : junctions_of_patch) {
            long gain = 0;
            for (const std::size_t j : edges) {
                const int sum = junctions[j].sum();
                gain += std::abs(sum) - std::abs(sum - 2 * junctions[j].sum_of_patch[p]);
            }
            if (gain <= 0) continue;
            for (const std::size_t j : edges) junctions[j].sum_of_patch[p] *= -1;
            turn_patch[p] = !turn_patch[p];
            changed = true;
        }
        if (!changed) break;
    }

    std::size_t turned = 0;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if ((turn[t] != 0) == turn_patch[patch[t]]) continue;
        std::swap(triangles[t][1], triangles[t][2]);
        ++turned;
    }
    return turned;
}

ShellTurns orient_outward(std::span<const Vector3d> positions, std::span<Triangle> triangles, const Shells& shells) {
    struct Shell {
        std::vector<Triangle> triangles;
        std::vector<std::uint32_t> ids;
        double volume = 0;
        Vector3d low = Vector3d::Constant(INFINITY), high = Vector3d::Constant(-INFINITY);
    };
    std::vector<Shell> shell(shells.count);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        Shell& s = shell[shells.of_triangle[t]];
        s.triangles.push_back(triangles[t]);
        s.ids.push_back(t);
        for (const std::uint32_t v : triangles[t]) {
            s.low = s.low.cwiseMin(positions[v]);
            s.high = s.high.cwiseMax(positions[v]);
        }
    }
    for (Shell& s : shell)  // about the shell's own corner, lest a far shell lose digits
        for (const Triangle& t : s.triangles)
            s.volume += (positions[t[0]] - s.low).dot((positions[t[1]] - s.low).cross(positions[t[2]] - s.low)) / 6;

    // a lies inside b when b winds around corners of a that are not on b.
    const auto inside = [&](const Shell& a, const Shell& b) {
        if (std::abs(b.volume) <= std::abs(a.volume) || (a.low - b.low).minCoeff() < 0 ||
            (b.high - a.high).minCoeff() < 0)
            return false;
        const std::size_t samples = std::min<std::size_t>(a.triangles.size(), 5);
        for (std::size_t n = 0; n < samples; ++n) {
            const Triangle& t = a.triangles[n * a.triangles.size() / samples];
            const Vector3d p = (positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3;
            if (std::abs(std::lround(winding_number(positions, b.triangles, p))) == 0) return false;
        }
        return true;
    };

    ShellTurns result;
    result.turned_triangle.assign(triangles.size(), 0);
    std::vector<bool> turn(shell.size(), false);
    for (std::size_t a = 0; a < shell.size(); ++a) {
        if (!(shell[a].volume < 0)) continue;
        bool cavity = false;
        for (std::size_t b = 0; b < shell.size() && !cavity; ++b) cavity = a != b && inside(shell[a], shell[b]);
        if (cavity) continue;
        turn[a] = true;
        // What lies inside an inverted shell was drawn inside out with it.
        for (std::size_t b = 0; b < shell.size(); ++b)
            if (a != b && inside(shell[b], shell[a])) turn[b] = true;
    }
    for (std::size_t a = 0; a < shell.size(); ++a) {
        result.cavities += turn[a] ? shell[a].volume > 0 : shell[a].volume < 0;
        if (!turn[a]) continue;
        ++result.turned;
        for (const std::uint32_t t : shell[a].ids) {
            std::swap(triangles[t][1], triangles[t][2]);
            result.turned_triangle[t] = 1;
        }
    }
    return result;
}

}  // namespace voxtone::slicer
