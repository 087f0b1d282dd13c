// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/vertex_colours.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

/// A piece of a triangle of the surface: its vertices and where they lie on that triangle.
struct Piece {
    std::array<std::uint32_t, 3> vertices;
    std::array<Eigen::Vector2f, 3> uv;
    std::uint32_t triangle;
};

struct Pieces {
    std::vector<Eigen::Vector3d> positions;
    std::vector<Piece> pieces;
};

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

double edge_length(const Pieces& mesh, std::uint32_t a, std::uint32_t b) {
    return (mesh.positions[a] - mesh.positions[b]).norm();
}

/// Edges cannot become shorter than this without more vertices than allowed: halving leaves edges between L/2 and L,
/// and a mesh of edges of about 0.7 L has one vertex per (sqrt(3)/2) (0.7 L)^2 of area.
double shortest_affordable_edge(const ColouredSurface& surface, std::size_t max_vertices) {
    double area = 0;
    for (const auto& t : surface.triangles) {
        const Eigen::Vector3d& a = surface.positions_mm[t[0]];
        area += 0.5 * (surface.positions_mm[t[1]] - a).cross(surface.positions_mm[t[2]] - a).norm();
    }
    return std::sqrt(area / (std::sqrt(3.0) / 2 * 0.49 * static_cast<double>(max_vertices)));
}

enum class Halving { done, nothing_to_do, no_room };

/// The middle of every edge that is too long, as a new vertex.
Halving halve_edges(Pieces& mesh, double longest, std::size_t max_vertices,
                    std::unordered_map<std::uint64_t, std::uint32_t>& middles) {
    middles.clear();
    std::vector<Eigen::Vector3d> added;
    for (const Piece& piece : mesh.pieces)
        for (int e = 0; e < 3; ++e) {
            const std::uint32_t a = piece.vertices[e], b = piece.vertices[(e + 1) % 3];
            if (edge_length(mesh, a, b) <= longest) continue;
            const auto number = static_cast<std::uint32_t>(mesh.positions.size() + added.size());
            if (middles.try_emplace(edge_key(a, b), number).second)
                added.push_back((mesh.positions[a] + mesh.positions[b]) / 2);
        }
    if (added.empty()) return Halving::nothing_to_do;
    if (mesh.positions.size() + added.size() > max_vertices) return Halving::no_room;
    mesh.positions.insert(mesh.positions.end(), added.begin(), added.end());
    return Halving::done;
}

/// A corner or the middle of an edge of a piece.
struct Corner {
    std::uint32_t vertex;
    Eigen::Vector2f uv;
};

/// Cuts a piece at the middles of its halved edges into two, three or four.
void cut(const Piece& piece, const std::unordered_map<std::uint64_t, std::uint32_t>& middles,
         const std::vector<Eigen::Vector3d>& positions, std::vector<Piece>& out) {
    std::array<Corner, 3> corner, middle{};
    std::array<bool, 3> halved{};
    for (std::size_t e = 0; e < 3; ++e) corner[e] = {piece.vertices[e], piece.uv[e]};
    for (std::size_t e = 0; e < 3; ++e) {
        const Corner &a = corner[e], &b = corner[(e + 1) % 3];
        const auto found = middles.find(edge_key(a.vertex, b.vertex));
        halved[e] = found != middles.end();
        if (halved[e]) middle[e] = {found->second, (a.uv + b.uv) / 2};
    }
    const auto add = [&](const Corner& a, const Corner& b, const Corner& c) {
        out.push_back({{a.vertex, b.vertex, c.vertex}, {a.uv, b.uv, c.uv}, piece.triangle});
    };
    const int cuts = halved[0] + halved[1] + halved[2];
    if (cuts == 0) {
        out.push_back(piece);
    } else if (cuts == 3) {
        for (std::size_t e = 0; e < 3; ++e) add(corner[e], middle[e], middle[(e + 2) % 3]);
        add(middle[0], middle[1], middle[2]);
    } else if (cuts == 1) {
        const std::size_t e = halved[0] ? 0 : halved[1] ? 1 : 2;
        add(corner[e], middle[e], corner[(e + 2) % 3]);
        add(middle[e], corner[(e + 1) % 3], corner[(e + 2) % 3]);
    } else {
        // The whole edge runs from `a` to `b`; `tip` is cut off, and the rest along its shorter diagonal.
        const std::size_t whole = !halved[0] ? 0 : !halved[1] ? 1 : 2;
        const Corner &a = corner[whole], &b = corner[(whole + 1) % 3], &tip = corner[(whole + 2) % 3];
        const Corner &from_b = middle[(whole + 1) % 3], &to_a = middle[(whole + 2) % 3];
        add(to_a, from_b, tip);
        const auto distance = [&](const Corner& p, const Corner& q) {
            return (positions[p.vertex] - positions[q.vertex]).norm();
        };
        if (distance(a, from_b) <= distance(b, to_a)) {
            add(a, b, from_b);
            add(a, from_b, to_a);
        } else {
            add(a, b, to_a);
            add(b, from_b, to_a);
        }
    }
}

double longest_edge(const Pieces& mesh) {
    double longest = 0;
    for (const Piece& piece : mesh.pieces)
        for (int e = 0; e < 3; ++e)
            longest = std::max(longest, edge_length(mesh, piece.vertices[e], piece.vertices[(e + 1) % 3]));
    return longest;
}

Pieces refine(const ColouredSurface& surface, const VertexColourOptions& options, const Progress* progress) {
    Pieces mesh;
    mesh.positions.assign(surface.positions_mm.begin(), surface.positions_mm.end());
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
        mesh.pieces.push_back(
            {surface.triangles[t], {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)}, t});
    const double wanted = std::max(options.edge_mm, shortest_affordable_edge(surface, options.max_vertices));
    std::unordered_map<std::uint64_t, std::uint32_t> middles;
    // The longest edges first, so that the room that there is goes where it is needed most.
    for (double longest = std::max(wanted, longest_edge(mesh)); longest > wanted;) {
        longest = std::max(wanted, longest / std::sqrt(2.0));
        Halving outcome;
        while ((outcome = halve_edges(mesh, longest, options.max_vertices, middles)) == Halving::done) {
            if (progress) progress->check_cancelled();
            std::vector<Piece> cut_pieces;
            cut_pieces.reserve(2 * mesh.pieces.size());
            for (const Piece& piece : mesh.pieces) cut(piece, middles, mesh.positions, cut_pieces);
            mesh.pieces = std::move(cut_pieces);
        }
        if (outcome == Halving::no_room) break;
    }
    return mesh;
}

/// Opens the seams: one vertex per position and colour.
io::ColouredMesh join(const Pieces& mesh, const std::vector<std::array<Eigen::Vector3f, 3>>& colours,
                      double same_colour, std::vector<SurfacePlace>& places) {
    constexpr std::uint32_t none = ~std::uint32_t{0};
    io::ColouredMesh result;
    std::vector<std::uint32_t> first(mesh.positions.size(), none), next;  // lists of the vertices at a position
    std::vector<Eigen::Vector3f> codes;
    const auto encoded = [](const Eigen::Vector3f& rgb) {
        return Eigen::Vector3f(rgb.unaryExpr([](float x) { return static_cast<float>(optics::srgb_encode(x)); }));
    };
    for (std::size_t i = 0; i < mesh.pieces.size(); ++i) {
        std::array<std::uint32_t, 3> triangle;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t position = mesh.pieces[i].vertices[c];
            const Eigen::Vector3f code = encoded(colours[i][c]);
            std::uint32_t vertex = first[position];
            while (vertex != none && (codes[vertex] - code).cwiseAbs().maxCoeff() > same_colour) vertex = next[vertex];
            if (vertex == none) {
                vertex = static_cast<std::uint32_t>(codes.size());
                codes.push_back(code);
                next.push_back(first[position]);
                first[position] = vertex;
                result.positions_mm.push_back(mesh.positions[position].cast<float>());
                result.rgb.push_back(colours[i][c]);
                places.push_back({mesh.pieces[i].triangle, mesh.pieces[i].uv[c].x(), mesh.pieces[i].uv[c].y()});
            }
            triangle[c] = vertex;
        }
        result.triangles.push_back(triangle);
    }
    return result;
}

}  // namespace

VertexColours vertex_colours(const ColouredSurface& surface, const VertexColourOptions& options,
                             const Progress* progress) {
    VOXTONE_EXPECT(options.edge_mm > 0 && options.max_vertices >= 1 && options.same_colour >= 0);
    const Pieces mesh = refine(surface, options, progress);
    std::vector<std::array<Eigen::Vector3f, 3>> colours(mesh.pieces.size());
    parallel_for(
        0, mesh.pieces.size(), 1024,
        [&](std::size_t i) {
            const Piece& piece = mesh.pieces[i];
            for (std::size_t c = 0; c < 3; ++c)
                colours[i][c] =
                    surface.colour(piece.triangle, piece.uv[c].x(), piece.uv[c].y()).cwiseMax(0.0f).cwiseMin(1.0f);
        },
        progress);
    VertexColours result;
    result.mesh = join(mesh, colours, options.same_colour, result.places);
    result.longest_edge_mm = longest_edge(mesh);
    return result;
}

}  // namespace voxtone::slicer
