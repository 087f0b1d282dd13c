// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/coincident_faces.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "slicer/mesh/disjoint_sets.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_orientation.h"

namespace voxtone::slicer {

namespace {

/// The lowest number of a vertex at the place of each.
std::vector<std::uint32_t> first_at_place(std::span<const Eigen::Vector3d> positions) {
    std::vector<std::uint32_t> order(positions.size()), first(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto place = [&](std::uint32_t v) {
        return std::tuple(positions[v].x(), positions[v].y(), positions[v].z());
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple_cat(place(a), std::tuple(a)) < std::tuple_cat(place(b), std::tuple(b));
    });
    for (std::size_t n = 0; n < order.size(); ++n)
        first[order[n]] = n > 0 && place(order[n]) == place(order[n - 1]) ? first[order[n - 1]] : order[n];
    return first;
}

struct PlacedFace {
    Triangle corners;  ///< ascending
    Triangle given;    ///< in the face's order
    std::uint32_t triangle;
    int sign;  ///< +1: the face goes round them in this order
};

/// Without those that have no area; by corners, then by number.
std::vector<PlacedFace> placed_faces(std::span<const Triangle> triangles, std::span<const std::uint32_t> place) {
    std::vector<PlacedFace> faces;
    faces.reserve(triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const Triangle at{place[triangles[t][0]], place[triangles[t][1]], place[triangles[t][2]]};
        if (collapsed(at)) continue;
        Triangle corners = at;
        std::sort(corners.begin(), corners.end());
        const auto begin = std::size_t(std::find(at.begin(), at.end(), corners[0]) - at.begin());
        faces.push_back({corners, at, t, at[(begin + 1) % 3] == corners[1] ? 1 : -1});
    }
    std::sort(faces.begin(), faces.end(), [](const PlacedFace& a, const PlacedFace& b) {
        return std::tie(a.corners, a.triangle) < std::tie(b.corners, b.triangle);
    });
    return faces;
}

/// Faces on the same three corners.
struct Pile {
    std::span<const PlacedFace> faces;
    int sum = 0;  ///< of their signs
};

std::vector<Pile> piles_of(std::span<const PlacedFace> faces) {
    std::vector<Pile> piles;
    for (std::size_t first = 0; first < faces.size();) {
        std::size_t last = first;
        Pile pile;
        for (; last < faces.size() && faces[last].corners == faces[first].corners; ++last) pile.sum += faces[last].sign;
        pile.faces = faces.subspan(first, last - first);
        piles.push_back(pile);
        first = last;
    }
    return piles;
}

/// Numbers of piles, shell by shell.
std::vector<std::vector<std::uint32_t>> shells_of(std::span<const Pile> piles) {
    std::vector<Triangle> faces;
    for (const Pile& pile : piles) faces.push_back(pile.faces[0].corners);
    DisjointSets sets(piles.size());
    for_each_edge(edge_uses(faces), [&](std::span<const EdgeUse> edge) {
        for (const EdgeUse& use : edge) sets.unite(edge[0].triangle, use.triangle);
    });
    std::vector<std::vector<std::uint32_t>> shells(piles.size());
    for (std::uint32_t p = 0; p < piles.size(); ++p) shells[sets.root(p)].push_back(p);
    std::erase_if(shells, [](const auto& shell) { return shell.empty(); });
    return shells;
}

/// What stays of a shell: of each pile a face, with its corners. Empty: the shell stays as it is.
struct SimpleShell {
    std::vector<std::uint32_t> source;
    std::vector<Triangle> triangles;
};

SimpleShell simple_shell(std::span<const Pile> piles, std::span<const std::uint32_t> shell) {
    const int times = std::abs(piles[shell.front()].sum);
    bool piled = false;
    for (const std::uint32_t p : shell) {
        if (std::abs(piles[p].sum) != times) return {};
        piled |= piles[p].faces.size() > 1;
    }
    if (!piled) return {};
    SimpleShell simple;
    for (const std::uint32_t p : shell) {
        const Pile& pile = piles[p];
        const auto face = std::find_if(pile.faces.begin(), pile.faces.end(),
                                       [&](const PlacedFace& f) { return times == 0 || f.sign * pile.sum > 0; });
        simple.source.push_back(face->triangle);
        simple.triangles.push_back(face->given);
    }
    if (times > 0) return simple;
    orient_consistently(simple.triangles);
    return open_edges(simple.triangles) == 0 ? simple : SimpleShell{};
}

}  // namespace

CoincidentFaces drop_coincident_faces(SolidMesh& mesh) {
    CoincidentFaces dropped;
    const std::vector<PlacedFace> faces = placed_faces(mesh.triangles, first_at_place(mesh.positions_mm));
    const std::vector<Pile> piles = piles_of(faces);
    if (piles.size() == faces.size()) return dropped;
    std::vector<bool> keep(mesh.triangles.size(), true);
    for (const std::vector<std::uint32_t>& shell : shells_of(piles)) {
        const SimpleShell simple = simple_shell(piles, shell);
        if (simple.source.empty()) continue;
        const bool two_sided = piles[shell.front()].sum == 0;
        for (const std::uint32_t p : shell) {
            for (const PlacedFace& face : piles[p].faces) keep[face.triangle] = false;
            (two_sided ? dropped.back_sides : dropped.copies) += piles[p].faces.size() - 1;
        }
        for (std::size_t n = 0; n < simple.source.size(); ++n) {
            keep[simple.source[n]] = true;
            mesh.triangles[simple.source[n]] = simple.triangles[n];
        }
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < keep.size(); ++t) {
        if (!keep[t]) continue;
        mesh.triangles[kept] = mesh.triangles[t];
        mesh.source_triangle[kept++] = mesh.source_triangle[t];
    }
    mesh.triangles.resize(kept);
    mesh.source_triangle.resize(kept);
    return dropped;
}

}  // namespace voxtone::slicer
