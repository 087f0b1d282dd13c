// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/polygon_triangles.h"

#include <algorithm>
#include <exception>
#include <optional>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <Eigen/Geometry>

#include "base/contracts.h"

namespace voxtone::io {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Outline = std::vector<Eigen::Vector2d>;

constexpr std::size_t most_corners = 20'000;  // what lies within is told corner by corner

Triangles fan(std::size_t corners) {
    Triangles triangles;
    for (std::uint32_t i = 2; i < corners; ++i) triangles.push_back({0, i - 1, i});
    return triangles;
}

/// Counterclockwise in the coordinate plane that is nearest to the polygon's.
Outline flattened(std::span<const Eigen::Vector3d> corners) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i)
        normal += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
    Outline outline;
    for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector3d d = corner - corners[0];
        outline.push_back(normal[axis] >= 0 ? Eigen::Vector2d(d[u], d[v]) : Eigen::Vector2d(d[v], d[u]));
    }
    return outline;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Turns left at each corner, and once around in all.
bool is_convex(const Outline& outline) {
    const std::size_t n = outline.size();
    int turns = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector2d a = outline[(i + 1) % n] - outline[i], b = outline[(i + 2) % n] - outline[(i + 1) % n];
        if (cross(a, b) < 0) return false;
        // Where the way goes from downwards to upwards it passes its lowest place.
        turns += a.y() < 0 && b.y() >= 0;
    }
    return turns <= 1;
}

bool is_within(const Outline& outline, const Eigen::Vector2d& p) {
    bool within = false;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
        const Eigen::Vector2d &a = outline[i], &b = outline[j];
        if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
            within = !within;
    }
    return within;
}

std::optional<Triangles> constrained(const Outline& outline) {
    Triangulation triangulation;
    std::vector<Triangulation::Vertex_handle> vertex;
    try {
        for (std::uint32_t i = 0; i < outline.size(); ++i) {
            const std::size_t before = triangulation.number_of_vertices();
            vertex.push_back(triangulation.insert({outline[i].x(), outline[i].y()}));
            if (triangulation.number_of_vertices() > before) vertex.back()->info() = i;
        }
        for (std::size_t i = 0; i < vertex.size(); ++i)
            if (const auto next = vertex[(i + 1) % vertex.size()]; next != vertex[i])
                triangulation.insert_constraint(vertex[i], next);
    } catch (const std::exception&) {  // outlines that cross
        return std::nullopt;
    }
    if (triangulation.dimension() < 2) return std::nullopt;
    Triangles triangles;
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
        const std::array<std::uint32_t, 3> corner{face->vertex(0)->info(), face->vertex(1)->info(),
                                                  face->vertex(2)->info()};
        if (is_within(outline, (outline[corner[0]] + outline[corner[1]] + outline[corner[2]]) / 3))
            triangles.push_back(corner);
    }
    return triangles;
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> polygon_triangles(std::span<const Eigen::Vector3d> corners) {
    VOXTONE_EXPECT(corners.size() >= 3);
    if (corners.size() == 3) return {{0, 1, 2}};
    const bool finite = std::ranges::all_of(corners, [](const Eigen::Vector3d& c) { return c.allFinite(); });
    if (!finite || corners.size() > most_corners) return fan(corners.size());
    const Outline outline = flattened(corners);
    if (is_convex(outline)) return fan(corners.size());
    std::optional<Triangles> triangles = constrained(outline);
    return triangles && !triangles->empty() ? std::move(*triangles) : fan(corners.size());
}

}  // namespace voxtone::io
