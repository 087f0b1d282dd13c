// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/alpha_wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

struct TooManyPoints {};

// Watches the shrinking: counts its points and lets the user stop it. CGAL 5.5 has no other way to stop it, and only
// this internal visitor to derive from; where a later CGAL renames it, the build fails here and nothing else changes.
struct Watch : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
    std::size_t points_left = 0;
    const Progress* progress = nullptr;
    StepShare* bar = nullptr;

    template <class Wrapper, class Vertex>
    void after_Steiner_point_insertion(const Wrapper&, Vertex) {
        if (points_left-- == 0) throw TooManyPoints{};
        if (progress) progress->check_cancelled();
        if (bar) bar->advance();
    }
};

}  // namespace

std::optional<Wrap> alpha_wrap(std::span<const Eigen::Vector3d> positions, std::span<const Triangle> triangles,
                               double alpha, double offset, std::size_t max_points, const Progress* progress,
                               StepShare* bar) {
    VOXTONE_EXPECT(alpha > 0 && offset > 0 && !triangles.empty());
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    std::vector<Point> points;
    points.reserve(positions.size());
    for (const Eigen::Vector3d& p : positions) points.emplace_back(p[0], p[1], p[2]);
    std::vector<std::array<std::size_t, 3>> faces;
    faces.reserve(triangles.size());
    for (const Triangle& t : triangles) faces.push_back({t[0], t[1], t[2]});

    CGAL::Surface_mesh<Point> mesh;
    Watch watch;
    watch.points_left = max_points;
    watch.progress = progress;
    watch.bar = bar;
    try {
        // CGAL 5.5 takes the visitor from the output's parameters, 6.0 from the input's; neither minds it in the
        // other's.
        CGAL::alpha_wrap_3(points, faces, alpha, offset, mesh, CGAL::parameters::visitor(std::ref(watch)),
                           CGAL::parameters::visitor(std::ref(watch)));
    } catch (const TooManyPoints&) {
        return std::nullopt;
    }

    Wrap wrap;
    wrap.positions.reserve(mesh.number_of_vertices());
    for (const auto v : mesh.vertices()) {
        VOXTONE_ENSURE(std::size_t(v) == wrap.positions.size());  // a fresh mesh has no gaps in its numbering
        wrap.positions.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
    }
    wrap.triangles.reserve(mesh.number_of_faces());
    for (const auto f : mesh.faces()) {
        Triangle t{};
        int corner = 0;
        for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
            t[corner++] = static_cast<std::uint32_t>(std::size_t(v));
        wrap.triangles.push_back(t);
    }
    return wrap;
}

}  // namespace voxtone::slicer
