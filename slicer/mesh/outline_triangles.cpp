// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/outline_triangles.h"

#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

enum class Side : std::uint8_t { unknown, outside, inside };

using OutlineKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, OutlineKernel>;
using Faces = CGAL::Triangulation_face_base_with_info_2<Side, OutlineKernel,
                                                        CGAL::Constrained_triangulation_face_base_2<OutlineKernel>>;
using OutlineTriangulation =
    CGAL::Constrained_Delaunay_triangulation_2<OutlineKernel, CGAL::Triangulation_data_structure_2<Corners, Faces>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

OutlineTriangulation triangulated(std::span<const Outline> outlines) {
    OutlineTriangulation made;
    std::uint32_t corner = 0;
    for (const Outline& outline : outlines) {
        VOXTONE_EXPECT(outline.size() >= 3);
        std::vector<OutlineTriangulation::Vertex_handle> vertices;
        for (const Eigen::Vector2d& p : outline) {
            const auto near = vertices.empty() ? OutlineTriangulation::Face_handle() : vertices.back()->face();
            vertices.push_back(made.insert({p.x(), p.y()}, near));
            vertices.back()->info() = corner++;
        }
        for (std::size_t i = 0; i < vertices.size(); ++i)
            made.insert_constraint(vertices[i], vertices[(i + 1) % vertices.size()]);
    }
    VOXTONE_EXPECT(made.number_of_vertices() == corner);
    return made;
}

/// Spreads from the face beyond the hull; an outline is crossed to the other side.
void find_sides(OutlineTriangulation& made) {
    for (auto face = made.all_faces_begin(); face != made.all_faces_end(); ++face) face->info() = Side::unknown;
    made.infinite_face()->info() = Side::outside;
    std::vector<OutlineTriangulation::Face_handle> open{made.infinite_face()};
    while (!open.empty()) {
        const auto face = open.back();
        open.pop_back();
        for (int edge = 0; edge < 3; ++edge) {
            const auto next = face->neighbor(edge);
            if (next->info() != Side::unknown) continue;
            const bool crosses = made.is_constrained({face, edge});
            next->info() = (face->info() == Side::inside) != crosses ? Side::inside : Side::outside;
            open.push_back(next);
        }
    }
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> outline_triangles(std::span<const Outline> outlines) {
    OutlineTriangulation made = triangulated(outlines);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    if (made.dimension() < 2) return triangles;
    find_sides(made);
    for (auto face = made.finite_faces_begin(); face != made.finite_faces_end(); ++face)
        if (face->info() == Side::inside)
            triangles.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    return triangles;
}

}  // namespace voxtone::slicer
