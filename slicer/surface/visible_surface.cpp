// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/surface/visible_surface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "voxtone/base/contracts.h"
#include "voxtone/slicer/mesh/exact_predicates.h"
#include "voxtone/slicer/mesh/mesh_chain.h"
#include "voxtone/slicer/mesh/mesh_crossings.h"
#include "voxtone/slicer/mesh/winding_number.h"

namespace voxtone::slicer {

using Eigen::Vector2f;
using Eigen::Vector3d;

namespace {

constexpr double just_off_mm = 1e-5;  // how far beside the surface its sides are looked at

// A triangle or a part of one.
struct Piece {
    std::array<Vector3d, 3> corner;
    std::array<Vector2f, 3> uv;
    std::uint32_t source;

    [[nodiscard]] Vector3d centre() const { return (corner[0] + corner[1] + corner[2]) / 3; }
    [[nodiscard]] double longest() const {
        return std::sqrt(std::max({(corner[1] - corner[0]).squaredNorm(), (corner[2] - corner[1]).squaredNorm(),
                                   (corner[0] - corner[2]).squaredNorm()}));
    }
    // In two, across the longest edge.
    [[nodiscard]] std::array<Piece, 2> halves() const {
        int c = 0;
        double longest2 = -1;
        for (int e = 0; e < 3; ++e) {
            const double l = (corner[(e + 1) % 3] - corner[e]).squaredNorm();
            if (l > longest2) longest2 = l, c = e;
        }
        std::array<Piece, 2> half{*this, *this};
        const int d = (c + 1) % 3;
        half[0].corner[d] = half[1].corner[c] = (corner[c] + corner[d]) / 2;
        half[0].uv[d] = half[1].uv[c] = (uv[c] + uv[d]) / 2;
        return half;
    }
};

class Collector {
public:
    explicit Collector(VisibleSurface& out) : out_(out) {}
    void add(const Piece& p) {
        const auto first = static_cast<std::uint32_t>(out_.positions_mm.size());
        out_.positions_mm.insert(out_.positions_mm.end(), p.corner.begin(), p.corner.end());
        add({first, first + 1, first + 2}, p.uv, p.source);
    }
    void add(const Triangle& t, const std::array<Vector2f, 3>& uv, std::uint32_t source) {
        out_.triangles.push_back(t);
        out_.source_uv.push_back(uv);
        out_.source_triangle.push_back(source);
    }

private:
    VisibleSurface& out_;
};

enum class Sight { visible, hidden, mixed };

// Adds the visible parts of a piece, in as few pieces as it takes. Returns what it is as a whole.
Sight add_visible(const Piece& piece, const std::function<Sight(const Piece&)>& look, std::vector<Piece>& out) {
    Sight sight = look(piece);
    if (sight == Sight::mixed) {
        const std::size_t before = out.size();
        const auto [a, b] = piece.halves();
        const Sight first = add_visible(a, look, out), second = add_visible(b, look, out);
        if (first != second || first == Sight::mixed) return Sight::mixed;
        out.resize(before);
        sight = first;
    }
    if (sight == Sight::visible) out.push_back(piece);
    return sight;
}

// Where corners of `mine` are in `source`: (u, v) of each.
std::array<Vector2f, 3> corner_uv(const Triangle& mine, const Triangle& source,
                                  const std::vector<Vector3d>& my_positions,
                                  const std::vector<Vector3d>& source_positions) {
    const Vector2f at[3] = {{0, 0}, {1, 0}, {0, 1}};
    std::array<Vector2f, 3> uv;
    for (int c = 0; c < 3; ++c) {
        // By number, or by place after welding.
        int best = 0;
        double best2 = std::numeric_limits<double>::infinity();
        for (int s = 0; s < 3; ++s) {
            const double d2 =
                mine[c] == source[s] ? -1 : (my_positions[mine[c]] - source_positions[source[s]]).squaredNorm();
            if (d2 < best2) best2 = d2, best = s;
        }
        uv[c] = at[best];
    }
    return uv;
}

}  // namespace

VisibleSurface find_visible_surface(const std::vector<Vector3d>& positions_mm,
                                    const std::vector<Triangle>& source_triangles, const RepairedMesh& repaired,
                                    double piece_mm, VisibleSurfaceReport* report) {
    const SolidMesh& solid = *repaired.solid;
    const TriangleTree& tree = repaired.solid.tree();
    VOXTONE_EXPECT(piece_mm > 0 && solid.source_triangle.size() == solid.triangles.size());
    const std::size_t count = solid.triangles.size();
    VisibleSurface out;
    out.positions_mm = solid.positions_mm;
    Collector collect(out);
    VisibleSurfaceReport seen;

    // What is one with what: neighbours through plain edges, as long as no other triangle crosses them.
    const bool plain = repaired.report.after.shells == 1 && repaired.report.after.crossing_pairs == 0 &&
                       repaired.report.after.nonmanifold_edges == 0;
    std::vector<std::vector<std::uint32_t>> crossings(count);
    std::vector<std::uint8_t> sight(count, std::uint8_t(Sight::visible));
    const auto hidden_at = [&](const Vector3d& p, const Vector3d& normal) {
        return winding_number(tree, p + just_off_mm * normal) != 0 &&
               winding_number(tree, p - just_off_mm * normal) != 0;
    };
    const auto normal_of = [&](std::uint32_t t) {
        const auto& [a, b, c] = solid.triangles[t];
        const Vector3d n =
            (solid.positions_mm[b] - solid.positions_mm[a]).cross(solid.positions_mm[c] - solid.positions_mm[a]);
        return Vector3d(n.norm() > 0 ? n.normalized() : Vector3d::UnitX());
    };
    if (!plain) {
        crossings = find_crossings(tree);
        std::vector<std::uint32_t> parent(count);
        std::iota(parent.begin(), parent.end(), 0u);
        const auto root = [&](std::uint32_t t) {
            while (parent[t] != t) t = parent[t] = parent[parent[t]];
            return t;
        };
        for_each_edge(edge_uses(solid.triangles), [&](std::span<const EdgeUse> edge) {
            if (edge.size() != 2 || !crossings[edge[0].triangle].empty() || !crossings[edge[1].triangle].empty())
                return;
            const std::uint32_t a = root(edge[0].triangle), b = root(edge[1].triangle);
            parent[std::max(a, b)] = std::min(a, b);
        });
        // Each patch is judged at its largest triangle.
        std::vector<std::uint32_t> largest(count);
        std::iota(largest.begin(), largest.end(), 0u);
        std::vector<double> areas(count);
        for (std::uint32_t t = 0; t < count; ++t) {
            areas[t] = area(solid.positions_mm, solid.triangles[t]);
            std::uint32_t& best = largest[root(t)];
            if (areas[t] > areas[best]) best = t;
        }
        for (std::uint32_t t = 0; t < count; ++t) {
            if (!crossings[t].empty()) continue;
            const std::uint32_t judge = largest[root(t)];
            if (root(t) == t) {
                const auto& [a, b, c] = solid.triangles[judge];
                const Vector3d centre = (solid.positions_mm[a] + solid.positions_mm[b] + solid.positions_mm[c]) / 3;
                sight[t] = std::uint8_t(hidden_at(centre, normal_of(judge)) ? Sight::hidden : Sight::visible);
            } else {
                sight[t] = sight[root(t)];  // a root is the lowest of its patch
            }
        }
    }

    // A source triangle at each corner, for the patches.
    constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> source_at_corner(solid.positions_mm.size(), nobody);
    for (std::uint32_t t = 0; t < count; ++t)
        if (solid.source_triangle[t] >= 0)
            for (const std::uint32_t v : solid.triangles[t])
                if (source_at_corner[v] == nobody) source_at_corner[v] = t;

    std::vector<Triangle> wrap;
    std::vector<Piece> pieces;
    for (std::uint32_t t = 0; t < count; ++t) {
        const Triangle& corners = solid.triangles[t];
        Piece whole{
            {solid.positions_mm[corners[0]], solid.positions_mm[corners[1]], solid.positions_mm[corners[2]]}, {}, 0};
        const std::int32_t source = solid.source_triangle[t];
        const bool patch = source < 0;
        if (patch && source_at_corner[corners[0]] == nobody) {  // of a wrap
            wrap.push_back(corners);
            continue;
        }
        if (patch) {
            ++seen.patches;
            whole.uv = {Vector2f(0, 0), Vector2f(1, 0), Vector2f(0, 1)};  // of itself, for now
        } else {
            whole.source = std::uint32_t(source);
            whole.uv = corner_uv(corners, source_triangles[whole.source], solid.positions_mm, positions_mm);
        }
        pieces.clear();
        Sight as_a_whole = Sight(sight[t]);
        if (!crossings[t].empty()) {
            const Vector3d normal = normal_of(t);
            const auto look = [&](const Piece& piece) {
                const bool crossed = std::any_of(crossings[t].begin(), crossings[t].end(), [&](std::uint32_t other) {
                    const auto& [a, b, c] = solid.triangles[other];
                    return triangles_meet(piece.corner,
                                          {solid.positions_mm[a], solid.positions_mm[b], solid.positions_mm[c]});
                });
                if (crossed && piece.longest() > piece_mm) return Sight::mixed;
                return hidden_at(piece.centre(), normal) ? Sight::hidden : Sight::visible;
            };
            as_a_whole = add_visible(whole, look, pieces);
        }
        seen.hidden += as_a_whole == Sight::hidden;
        seen.cut += as_a_whole == Sight::mixed;
        if (as_a_whole == Sight::hidden) continue;
        if (!patch && as_a_whole == Sight::visible) {
            collect.add(corners, whole.uv, whole.source);
            continue;
        }
        if (as_a_whole == Sight::visible) pieces.assign(1, whole);
        if (!patch) {
            for (const Piece& p : pieces) collect.add(p);
            continue;
        }
        // Each piece of a patch takes the colour of the corner nearest to it, in six parts where it is the whole patch.
        for (const Piece& p : pieces) {
            const Vector3d middle = p.centre();
            for (int c = 0; c < 3; ++c)
                for (const int side : {(c + 1) % 3, (c + 2) % 3}) {
                    Piece part{{p.corner[c], (p.corner[c] + p.corner[side]) / 2, middle}, {}, 0};
                    const Vector2f place = 0.5f * p.uv[c] + 0.5f * (p.uv[0] + p.uv[1] + p.uv[2]) / 3;
                    const float rest = 1 - place[0] - place[1];
                    const int nearest = rest >= place[0] && rest >= place[1] ? 0 : place[0] >= place[1] ? 1 : 2;
                    const std::uint32_t neighbour = source_at_corner[corners[nearest]];
                    part.source = std::uint32_t(solid.source_triangle[neighbour]);
                    const auto uv = corner_uv(solid.triangles[neighbour], source_triangles[part.source],
                                              solid.positions_mm, positions_mm);
                    const auto& n = solid.triangles[neighbour];
                    part.uv.fill(uv[std::size_t(std::find(n.begin(), n.end(), corners[nearest]) - n.begin())]);
                    collect.add(part);
                }
        }
    }

    if (!wrap.empty()) {
        const TriangleTree wrap_tree(solid.positions_mm, wrap);
        const double reach = 4 * repaired.report.wrap_offset_mm;
        const auto hidden_point = [&](const Vector3d& p) {
            const TriangleTree::Nearest n = wrap_tree.nearest(p, TriangleTree::none, reach);
            if (n.triangle == TriangleTree::none) return true;
            const Vector3d out_of_wrap = n.distance > 0 ? Vector3d((n.point - p) / n.distance) : Vector3d::UnitX();
            return winding_number(tree, n.point + just_off_mm * out_of_wrap) != 0;
        };
        const auto look = [&](const Piece& piece) {
            if (piece.longest() > 10 * piece_mm) return Sight::mixed;
            const Vector3d centre = piece.centre();
            int hidden = hidden_point(centre);
            if (piece.longest() <= piece_mm) return hidden ? Sight::hidden : Sight::visible;
            for (const Vector3d& c : piece.corner) hidden += hidden_point(0.9 * c + 0.1 * centre);
            return hidden == 0 ? Sight::visible : hidden == 4 ? Sight::hidden : Sight::mixed;
        };
        for (const std::uint32_t source : repaired.wrapped_triangles) {
            const Triangle& corners = source_triangles[source];
            const Piece whole{{positions_mm[corners[0]], positions_mm[corners[1]], positions_mm[corners[2]]},
                              {Vector2f(0, 0), Vector2f(1, 0), Vector2f(0, 1)},
                              source};
            pieces.clear();
            const Sight as_a_whole = add_visible(whole, look, pieces);
            seen.hidden += as_a_whole == Sight::hidden;
            seen.cut += as_a_whole == Sight::mixed;
            for (const Piece& p : pieces) collect.add(p);
        }
    }
    if (report) *report = seen;
    return out;
}

double coloured_area_mm2(const VisibleSurface& surface) {
    double area = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const auto& p = surface.positions_mm;
        area += 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
    }
    return area;
}

}  // namespace voxtone::slicer
