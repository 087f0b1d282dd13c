// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/polygon_triangles.h"

#include <algorithm>
#include <exception>
#include <optional>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <fmt/core.h>
#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/error.h"

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

constexpr std::size_t most_corners = 50'000;  // of one that is not convex

/// Corners; beyond it the slivers at one of them cost all who search among them.
constexpr std::size_t most_of_fan = 1'000;

/// The outline halved again and again: no corner has more triangles than there are halvings on its two sides.
Triangles halved(std::size_t corners) {
    Triangles triangles;
    std::vector<std::array<std::uint32_t, 2>> chains{{0, static_cast<std::uint32_t>(corners - 1)}};
    while (!chains.empty()) {
        const auto [first, last] = chains.back();
        chains.pop_back();
        if (last - first < 2) continue;
        const std::uint32_t middle = first + (last - first) / 2;
        triangles.push_back({first, middle, last});
        chains.push_back({first, middle});
        chains.push_back({middle, last});
    }
    return triangles;
}

/// Of a convex outline; of others what closes a surface as well as any.
Triangles without_inside(std::size_t corners) {
    if (corners > most_of_fan) return halved(corners);
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

/// Which points are within an outline: its edges, sorted into strips by how high they reach, so that a point is held
/// against those of its strip alone.
class Inside {
public:
    explicit Inside(const Outline& outline) : outline_(outline) {
        const auto below = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.y() < b.y(); };
        const auto [low, high] = std::ranges::minmax_element(outline, below);
        low_ = low->y();
        height_ = high->y() - low_;
        edges_.resize(std::clamp<std::size_t>(outline.size() / 8, 1, most_strips));
        for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
            const auto [from, to] = std::minmax({strip_of(outline[i].y()), strip_of(outline[j].y())});
            for (std::size_t strip = from; strip <= to; ++strip)
                edges_[strip].push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
        }
    }
    [[nodiscard]] bool has(const Eigen::Vector2d& p) const {
        bool within = false;
        for (const auto& [i, j] : edges_[strip_of(p.y())]) {
            const Eigen::Vector2d &a = outline_[i], &b = outline_[j];
            if ((a.y() > p.y()) != (b.y() > p.y()) &&
                p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
                within = !within;
        }
        return within;
    }

private:
    static constexpr std::size_t most_strips = 512;
    /// Never higher for what is lower.
    [[nodiscard]] std::size_t strip_of(double y) const {
        if (!(height_ > 0)) return 0;
        const double place = (y - low_) / height_ * static_cast<double>(edges_.size());
        return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(edges_.size() - 1)));
    }

    const Outline& outline_;
    double low_ = 0, height_ = 0;
    std::vector<std::vector<std::array<std::uint32_t, 2>>> edges_;
};

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
    const Inside inside(outline);
    Triangles triangles;
    for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
        const std::array<std::uint32_t, 3> corner{face->vertex(0)->info(), face->vertex(1)->info(),
                                                  face->vertex(2)->info()};
        if (inside.has((outline[corner[0]] + outline[corner[1]] + outline[corner[2]]) / 3)) triangles.push_back(corner);
    }
    return triangles;
}

/// Cosine of the angle between two triangles of a quad, one of them from `i` on; that of no area lies across any.
double flatness(std::span<const Eigen::Vector3d> quad, std::size_t i) {
    const auto normal = [&](std::size_t k) {
        const Eigen::Vector3d &a = quad[k % 4], &b = quad[(k + 1) % 4], &c = quad[(k + 2) % 4];
        return Eigen::Vector3d((b - a).cross(c - a).normalized());
    };
    return normal(i).dot(normal(i + 2));
}

/// Of a convex quad: along one diagonal, unless it folds less at the other.
Triangles quad_triangles(std::span<const Eigen::Vector3d> quad) {
    constexpr double alike = 1e-6;  // folds of a thousandth of a radian, which are the rounding of a flat one
    if (flatness(quad, 1) > flatness(quad, 0) + alike) return {{0, 1, 3}, {1, 2, 3}};
    return {{0, 1, 2}, {0, 2, 3}};
}

Triangles cut(std::span<const Eigen::Vector3d> corners, std::string_view file) {
    const bool finite = std::ranges::all_of(corners, [](const Eigen::Vector3d& c) { return c.allFinite(); });
    if (!finite) return without_inside(corners.size());
    const Outline outline = flattened(corners);
    if (is_convex(outline)) return corners.size() == 4 ? quad_triangles(corners) : without_inside(corners.size());
    if (corners.size() > most_corners)
        throw InputError(
            fmt::format("{}: a face has {} corners and is not convex, and such faces are cut into triangles up to {} "
                        "corners; export the model with triangles",
                        file, corners.size(), most_corners));
    std::optional<Triangles> triangles = constrained(outline);
    return triangles && !triangles->empty() ? std::move(*triangles) : without_inside(corners.size());
}

bool lies_before(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> polygon_triangles(std::span<const Eigen::Vector3d> corners,
                                                            std::string_view file, bool by_place) {
    VOXTONE_EXPECT(corners.size() >= 3);
    const std::size_t n = corners.size();
    if (n == 3) return {{0, 1, 2}};
    if (!by_place) return cut(corners, file);
    // From the corner that lies first towards the neighbour that does, so that a face and its back side are cut alike.
    const auto first = static_cast<std::size_t>(std::ranges::min_element(corners, lies_before) - corners.begin());
    const bool turned = lies_before(corners[(first + n - 1) % n], corners[(first + 1) % n]);
    const auto at = [&](std::size_t i) { return (first + (turned ? n - i : i)) % n; };
    std::vector<Eigen::Vector3d> ordered;
    ordered.reserve(n);
    for (std::size_t i = 0; i < n; ++i) ordered.push_back(corners[at(i)]);
    Triangles triangles = cut(ordered, file);
    for (auto& triangle : triangles) {
        for (std::uint32_t& corner : triangle) corner = static_cast<std::uint32_t>(at(corner));
        if (turned) std::swap(triangle[1], triangle[2]);
    }
    return triangles;
}

}  // namespace voxtone::io
