// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/coincident_faces.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include "slicer/mesh/disjoint_sets.h"
#include "slicer/mesh/hole_filling.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_orientation.h"
#include "slicer/mesh/open_pieces.h"

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

/// What stays of a shell: of piles a face, with its corners. Empty: the shell stays as it is.
struct SimpleShell {
    std::vector<std::uint32_t> source;
    std::vector<Triangle> triangles;
};

/// How many faces of each side a pile of a two-sided shell has, as parts of what all of them have in common: 2 where
/// two bodies drawn so share a face.
int least_times(std::span<const Pile> piles, std::span<const std::uint32_t> shell) {
    int least = 0;
    for (const std::uint32_t p : shell) least = std::gcd(least, static_cast<int>(piles[p].faces.size() / 2));
    return least;
}

/// Turns what encloses less than nothing once its holes are filled.
void turn_positive(std::span<const Eigen::Vector3d> positions, SimpleShell& simple, std::span<const HoleFill> fills) {
    std::vector<Triangle> all = simple.triangles;
    for (const HoleFill& fill : fills) all.insert(all.end(), fill.triangles.begin(), fill.triangles.end());
    const Shells shells = find_shells(all);
    std::vector<double> volume(shells.count);
    const Eigen::Vector3d& origin = positions[all.front()[0]];
    for (std::size_t t = 0; t < all.size(); ++t) {
        const Eigen::Vector3d a = positions[all[t][0]] - origin, b = positions[all[t][1]] - origin,
                              c = positions[all[t][2]] - origin;
        volume[shells.of_triangle[t]] += a.dot(b.cross(c)) / 6;
    }
    for (std::size_t t = 0; t < simple.triangles.size(); ++t)
        if (volume[shells.of_triangle[t]] < 0) std::swap(simple.triangles[t][1], simple.triangles[t][2]);
}

/// Of a shell with as many faces of either side everywhere.
SimpleShell one_sided(std::span<const Eigen::Vector3d> positions, std::span<const Pile> piles,
                      std::span<const std::uint32_t> shell, bool sheets) {
    SimpleShell simple;
    const int times = least_times(piles, shell);
    for (const std::uint32_t p : shell) {
        if (static_cast<int>(piles[p].faces.size() / 2) / times % 2 == 0) continue;  // between two bodies
        simple.source.push_back(piles[p].faces[0].triangle);
        simple.triangles.push_back(piles[p].faces[0].given);
    }
    if (simple.triangles.empty()) return {};
    orient_consistently(simple.triangles);
    const std::vector<HoleFill> fills = fill_holes(positions, simple.triangles);
    const std::vector<OpenPiece> open = open_pieces(positions, simple.triangles, fills);
    const bool body = std::ranges::all_of(open, [](const OpenPiece& p) { return p.kind == OpenPiece::Kind::body; });
    if (!body && !sheets) return {};
    if (body) turn_positive(positions, simple, fills);
    return simple;
}

SimpleShell simple_shell(std::span<const Eigen::Vector3d> positions, std::span<const Pile> piles,
                         std::span<const std::uint32_t> shell, bool sheets) {
    const int times = std::abs(piles[shell.front()].sum);
    bool piled = false;
    for (const std::uint32_t p : shell) {
        if (std::abs(piles[p].sum) != times) return {};
        piled |= piles[p].faces.size() > 1;
    }
    if (!piled) return {};
    if (times == 0) return one_sided(positions, piles, shell, sheets);
    SimpleShell simple;
    for (const std::uint32_t p : shell) {
        const Pile& pile = piles[p];
        const auto face = std::find_if(pile.faces.begin(), pile.faces.end(),
                                       [&](const PlacedFace& f) { return f.sign * pile.sum > 0; });
        simple.source.push_back(face->triangle);
        simple.triangles.push_back(face->given);
    }
    return simple;
}

}  // namespace

CoincidentFaces drop_coincident_faces(SolidMesh& mesh, bool sheets) {
    CoincidentFaces dropped;
    const std::vector<PlacedFace> faces = placed_faces(mesh.triangles, first_at_place(mesh.positions_mm));
    const std::vector<Pile> piles = piles_of(faces);
    if (piles.size() == faces.size()) return dropped;
    std::vector<bool> keep(mesh.triangles.size(), true);
    for (const std::vector<std::uint32_t>& shell : shells_of(piles)) {
        const bool two_sided = piles[shell.front()].sum == 0;
        const SimpleShell simple = simple_shell(mesh.positions_mm, piles, shell, sheets);
        if (simple.source.empty()) {
            if (two_sided)
                for (const std::uint32_t p : shell)
                    dropped.sheet_mm2 += area(mesh.positions_mm, piles[p].faces[0].given);
            continue;
        }
        std::size_t there = 0;
        for (const std::uint32_t p : shell) {
            there += piles[p].faces.size();
            for (const PlacedFace& face : piles[p].faces) {
                keep[face.triangle] = false;
                if (piles[p].faces.size() > 1)
                    dropped.piled.push_back({face.given, mesh.source_triangle[face.triangle]});
            }
        }
        (two_sided ? dropped.back_sides : dropped.copies) += there - simple.source.size();
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
