// SPDX-License-Identifier: GPL-3.0-or-later
//
// A triangle mesh seen as a chain: per undirected edge, how often faces run it either way. Where these cancel at every
// edge, the mesh bounds a body in the sense of winding numbers, however it crosses itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

using Triangle = std::array<std::uint32_t, 3>;

/// A corner twice: such a face adds nothing to a chain.
[[nodiscard]] inline bool collapsed(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// One face at an edge.
struct EdgeUse {
    std::uint32_t low, high;  ///< corners, low < high
    std::uint32_t triangle;
    std::int32_t sign;  ///< +1: the face runs from low to high
};

/// All uses of all edges, sorted by edge and then by triangle. Collapsed faces have no edges.
[[nodiscard]] std::vector<EdgeUse> edge_uses(std::span<const Triangle> triangles);

/// Calls visit(uses of one edge) for each edge.
template <class Visit>
void for_each_edge(std::span<const EdgeUse> uses, Visit&& visit) {
    for (std::size_t first = 0; first < uses.size();) {
        std::size_t last = first + 1;
        while (last < uses.size() && uses[last].low == uses[first].low && uses[last].high == uses[first].high) ++last;
        visit(uses.subspan(first, last - first));
        first = last;
    }
}

/// What the uses of one edge add up to; zero on a closed chain.
[[nodiscard]] inline int edge_sum(std::span<const EdgeUse> uses) {
    int sum = 0;
    for (const EdgeUse& u : uses) sum += u.sign;
    return sum;
}

/// Edges whose uses do not cancel.
[[nodiscard]] std::size_t open_edges(std::span<const Triangle> triangles);

/// Shells: triangles joined through edges that two faces share, and through edges with more faces as far as that is
/// needed for each shell to be closed. Returns a number per triangle, 0 .. count - 1 in order of first triangles.
struct Shells {
    std::vector<std::uint32_t> of_triangle;
    std::uint32_t count = 0;
};
[[nodiscard]] Shells find_shells(std::span<const Triangle> triangles);

[[nodiscard]] double signed_volume(std::span<const Eigen::Vector3d> positions, const Triangle& t);
[[nodiscard]] double area(std::span<const Eigen::Vector3d> positions, const Triangle& t);

/// Winding number of some triangles around a point, as a real number (it is an integer off a closed chain).
/// Based on: A. van Oosterom, J. Strackee, "The solid angle of a plane triangle", 1983.
[[nodiscard]] double winding_number(std::span<const Eigen::Vector3d> positions, std::span<const Triangle> triangles,
                                    const Eigen::Vector3d& p);

}  // namespace voxtone::slicer
