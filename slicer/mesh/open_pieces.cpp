// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/open_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include <Eigen/Geometry>

#include "slicer/mesh/disjoint_sets.h"
#include "slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

constexpr double large_hole = 1.0 / 3, sheet_hole = 0.7;  // fill by own area
constexpr double flat = 0.02;                             // off its plane, by a hole's size
constexpr double least_rim_sine = 0.5;                    // of the angle at which a floor is left

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

/// Edges along which the faces are open, as these run them, and a face of each.
std::map<DirectedEdge, std::uint32_t> rims_of(std::span<const Triangle> triangles) {
    std::map<DirectedEdge, std::uint32_t> rims;
    for_each_edge(edge_uses(triangles), [&](std::span<const EdgeUse> uses) {
        const int sum = edge_sum(uses);
        for (const EdgeUse& use : uses)
            if (use.sign * sum > 0)
                rims.try_emplace(sum > 0 ? DirectedEdge{use.low, use.high} : DirectedEdge{use.high, use.low},
                                 use.triangle);
    });
    return rims;
}

/// Calls visit(face, from, to) for each edge of a hole, which a face runs from `to` to `from`.
template <class Visit>
void for_each_rim(const HoleFill& hole, const std::map<DirectedEdge, std::uint32_t>& rims, Visit&& visit) {
    for (std::size_t i = 0; i < hole.loop.size(); ++i) {
        const std::uint32_t from = hole.loop[i], to = hole.loop[(i + 1) % hole.loop.size()];
        if (const auto rim = rims.find({to, from}); rim != rims.end()) visit(rim->second, from, to);
    }
}

Vector3d normal_of(std::span<const Vector3d> positions, const Triangle& t) {
    return (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]);
}

/// Whether a hole is the missing floor of the piece: flat, with all of the piece on one side, which rises from it.
bool is_floor(std::span<const Vector3d> positions, std::span<const Triangle> triangles, const OpenPiece& piece,
              const std::map<DirectedEdge, std::uint32_t>& rims, const HoleFill& hole) {
    const std::size_t n = hole.loop.size();
    Vector3d middle = Vector3d::Zero(), normal = Vector3d::Zero();
    Eigen::AlignedBox3d box;
    for (const std::uint32_t v : hole.loop) {
        middle += positions[v] / static_cast<double>(n);
        box.extend(positions[v]);
    }
    for (std::size_t i = 0; i < n; ++i)
        normal += (positions[hole.loop[i]] - middle).cross(positions[hole.loop[(i + 1) % n]] - middle);
    if (!(normal.norm() > 0)) return false;
    normal.normalize();
    const double off = flat * box.diagonal().norm();
    for (const std::uint32_t v : hole.loop)
        if (std::abs(normal.dot(positions[v] - middle)) > off) return false;
    double low = 0, high = 0;
    for (const std::uint32_t t : piece.faces)
        for (const std::uint32_t v : triangles[t]) {
            const double height = normal.dot(positions[v] - middle);
            low = std::min(low, height);
            high = std::max(high, height);
        }
    if (std::min(-low, high) > off) return false;
    double length = 0, sine = 0;
    for_each_rim(hole, rims, [&](std::uint32_t t, std::uint32_t from, std::uint32_t to) {
        const Vector3d face = normal_of(positions, triangles[t]);
        if (!(face.norm() > 0)) return;
        const double edge = (positions[to] - positions[from]).norm();
        length += edge;
        sine += edge * face.normalized().cross(normal).norm();
    });
    return length > 0 && sine > least_rim_sine * length;
}

OpenPiece::Kind kind_of(std::span<const Vector3d> positions, std::span<const Triangle> triangles,
                        std::span<const HoleFill> fills, const std::map<DirectedEdge, std::uint32_t>& rims,
                        const OpenPiece& piece) {
    if (piece.fill_mm2 <= large_hole * piece.own_mm2) return OpenPiece::Kind::body;
    double guessed = 0;  // area of fills that are no floors
    for (const std::uint32_t f : piece.fills) {
        if (is_floor(positions, triangles, piece, rims, fills[f])) continue;
        for (const Triangle& t : fills[f].triangles) guessed += area(positions, t);
    }
    if (guessed <= 0.1 * piece.fill_mm2) return OpenPiece::Kind::body;
    return piece.fill_mm2 > sheet_hole * piece.own_mm2 ? OpenPiece::Kind::sheet : OpenPiece::Kind::torn;
}

/// Where each corner of a piece lies `thickness_mm` behind it, so that its faces are so thick; at edges sharper than 60
/// degrees less.
std::unordered_map<std::uint32_t, Vector3d> behind(const SolidMesh& mesh, const OpenPiece& piece, double thickness_mm) {
    struct Corner {
        Vector3d normal = Vector3d::Zero();
        double least = 1;  ///< of the cosines to the faces
    };
    std::unordered_map<std::uint32_t, Corner> corners;
    for (const std::uint32_t t : piece.faces)
        for (const std::uint32_t v : mesh.triangles[t])
            corners[v].normal += normal_of(mesh.positions_mm, mesh.triangles[t]);
    for (auto& [v, corner] : corners)
        if (corner.normal.norm() > 0) corner.normal.normalize();
    for (const std::uint32_t t : piece.faces) {
        const Vector3d face = normal_of(mesh.positions_mm, mesh.triangles[t]);
        if (!(face.norm() > 0)) continue;
        for (const std::uint32_t v : mesh.triangles[t])
            corners[v].least = std::min(corners[v].least, corners[v].normal.dot(face.normalized()));
    }
    std::unordered_map<std::uint32_t, Vector3d> places;
    for (const auto& [v, corner] : corners)
        places[v] = mesh.positions_mm[v] - thickness_mm / std::max(corner.least, 0.5) * corner.normal;
    return places;
}

}  // namespace

std::vector<OpenPiece> open_pieces(std::span<const Vector3d> positions, std::span<const Triangle> triangles,
                                   std::span<const HoleFill> fills) {
    if (fills.empty()) return {};
    const Shells shells = find_shells(triangles);
    const std::map<DirectedEdge, std::uint32_t> rims = rims_of(triangles);
    DisjointSets sets(shells.count);
    std::vector<std::uint32_t> of_fill(fills.size(), shells.count);
    for (std::size_t f = 0; f < fills.size(); ++f)
        for_each_rim(fills[f], rims, [&](std::uint32_t t, std::uint32_t, std::uint32_t) {
            const std::uint32_t shell = shells.of_triangle[t];
            if (of_fill[f] == shells.count) of_fill[f] = shell;
            sets.unite(of_fill[f], shell);
        });
    std::vector<OpenPiece> pieces(shells.count);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        OpenPiece& piece = pieces[sets.root(shells.of_triangle[t])];
        piece.own_mm2 += area(positions, triangles[t]);
        piece.faces.push_back(t);
    }
    for (std::uint32_t f = 0; f < fills.size(); ++f) {
        if (of_fill[f] == shells.count) continue;
        OpenPiece& piece = pieces[sets.root(of_fill[f])];
        piece.fills.push_back(f);
        for (const Triangle& t : fills[f].triangles) piece.fill_mm2 += area(positions, t);
    }
    std::erase_if(pieces, [](const OpenPiece& piece) { return piece.fills.empty() || piece.faces.empty(); });
    for (OpenPiece& piece : pieces) piece.kind = kind_of(positions, triangles, fills, rims, piece);
    return pieces;
}

void add_other_side(SolidMesh& mesh, const OpenPiece& piece, double thickness_mm) {
    const auto add = [&](const Triangle& t, std::int32_t source) {
        mesh.triangles.push_back(t);
        mesh.source_triangle.push_back(source);
    };
    if (thickness_mm <= 0) {
        for (const std::uint32_t t : piece.faces) {
            const Triangle front = mesh.triangles[t];
            add({front[0], front[2], front[1]}, mesh.source_triangle[t]);
        }
        return;
    }
    std::unordered_map<std::uint32_t, std::uint32_t> back;
    const std::unordered_map<std::uint32_t, Vector3d> places = behind(mesh, piece, thickness_mm);
    for (const std::uint32_t t : piece.faces)
        for (const std::uint32_t v : mesh.triangles[t])
            if (back.try_emplace(v, static_cast<std::uint32_t>(mesh.positions_mm.size())).second)
                mesh.positions_mm.push_back(places.at(v));
    std::vector<Triangle> own;
    for (const std::uint32_t t : piece.faces) own.push_back(mesh.triangles[t]);
    for (std::size_t n = 0; n < own.size(); ++n)
        add({back[own[n][0]], back[own[n][2]], back[own[n][1]]}, mesh.source_triangle[piece.faces[n]]);
    for_each_edge(edge_uses(own), [&](std::span<const EdgeUse> uses) {
        int sum = edge_sum(uses);
        for (const EdgeUse& use : uses) {
            if (use.sign * sum <= 0) continue;
            const std::uint32_t from = use.sign > 0 ? use.low : use.high, to = use.sign > 0 ? use.high : use.low;
            const std::int32_t source = mesh.source_triangle[piece.faces[use.triangle]];
            add({to, from, back[from]}, source);
            add({to, back[from], back[to]}, source);
            sum -= use.sign;
        }
    });
}

}  // namespace voxtone::slicer
