// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/cut_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>
#include <Eigen/Dense>

#include "base/error.h"
#include "base/warning.h"

namespace voxtone::io {

namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = Mesh::Face_index;

constexpr const char* source_of_faces = "f:source";
constexpr std::int64_t wall = -1;
/// By the body's size: a tenth of a micrometre on a body of 100 mm, far below a voxel.
constexpr double least_growth = 1e-6;

/// Of each face, the triangle of the body that it is of, or `wall`.
Mesh::Property_map<Face, std::int64_t> sources(Mesh& mesh) {
    return mesh.add_property_map<Face, std::int64_t>(source_of_faces, wall).first;
}

/// Hands sources on as faces are split and copied.
struct KeepSources : processing::Corefinement::Default_visitor<Mesh> {
    std::int64_t split = wall;
    void before_subface_creations(Face face, Mesh& mesh) { split = sources(mesh)[face]; }
    void after_subface_created(Face face, Mesh& mesh) { sources(mesh)[face] = split; }
    void after_face_copy(Face from, Mesh& old_mesh, Face to, Mesh& new_mesh) {
        sources(new_mesh)[to] = sources(old_mesh)[from];
    }
};

class Cutter {
public:
    Cutter(ModelParts& parts, const std::string& model) : parts_(parts), model_(model) {}

    void cut(const std::vector<VolumeCut>& cuts) {
        std::vector<bool> replaced(parts_.triangles.size());
        for (const VolumeCut& c : cuts) {
            for (const TriangleRange& tool : c.tools)
                std::fill_n(replaced.begin() + long(tool.first), size(tool), true);
            if (c.tools.empty()) continue;
            for (const TriangleRange& body : c.bodies) {
                std::fill_n(replaced.begin() + long(body.first), size(body), true);
                add(body, difference(body, c.tools));
            }
        }
        replaced.resize(parts_.triangles.size());
        keep_rest(replaced);
        if (white_walls_)
            parts_.warnings.push_back(named_warning(
                "which-colour",
                fmt::format(
                    "Where {} has something cut out of parts of several colours, the walls of the cuts are white.",
                    model_)));
    }

private:
    static std::size_t size(const TriangleRange& range) { return range.last - range.first; }

    [[noreturn]] void fail(std::string_view why) const {
        throw InputError(fmt::format(
            "{} has a negative volume, which is to be cut out of others, and {}; repair them, or let the slicer cut "
            "(boolean difference) and export the mesh",
            model_, why));
    }

    Mesh mesh_of(const TriangleRange& range, bool is_body) const {
        Mesh mesh;
        auto source = sources(mesh);
        std::map<std::array<double, 3>, Mesh::Vertex_index> vertices;
        for (std::size_t t = range.first; t < range.last; ++t) {
            std::array<Mesh::Vertex_index, 3> corners;
            for (std::size_t c = 0; c < 3; ++c) {
                const Eigen::Vector3d& p = parts_.positions[parts_.triangles[t][c]];
                const auto [found, is_new] = vertices.try_emplace({p.x(), p.y(), p.z()});
                if (is_new) found->second = mesh.add_vertex({p.x(), p.y(), p.z()});
                corners[c] = found->second;
            }
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
            const Face face = mesh.add_face(corners[0], corners[1], corners[2]);
            if (face == Mesh::null_face()) fail("one of them has edges or corners where its faces do not fit together");
            if (is_body) source[face] = static_cast<std::int64_t>(t);
        }
        if (mesh.number_of_faces() == 0 || !CGAL::is_closed(mesh)) fail("one of them is not closed");
        processing::orient_to_bound_a_volume(mesh);
        return mesh;
    }

    /// What the tool leaves; nothing where that would be no surface in which two faces meet at each edge, as where a
    /// wall is touched from within along a line.
    std::optional<Mesh> subtract(Mesh body, Mesh tool) const {
        Mesh result;
        try {
            if (!processing::corefine_and_compute_difference(
                    body, tool, result, CGAL::parameters::visitor(KeepSources()).throw_on_self_intersection(true)))
                return std::nullopt;
        } catch (const processing::Corefinement::Self_intersection_exception&) {
            fail("one of them crosses itself");
        }
        result.collect_garbage();
        return result;
    }

    Mesh difference(const TriangleRange& body, const std::vector<TriangleRange>& tools) const {
        Mesh left = mesh_of(body, true);
        const CGAL::Bbox_3 box = processing::bbox(left);
        const double size = std::hypot(box.x_span(), box.y_span(), box.z_span());
        for (const TriangleRange& range : tools) {
            const Mesh tool = mesh_of(range, false);
            if (left.number_of_faces() == 0) break;
            std::optional<Mesh> result = subtract(left, tool);
            for (const double by : {1.0, -1.0, 2.7, -2.7}) {
                if (result) break;
                result = subtract(left, grown(tool, by * least_growth * size));
            }
            if (!result) fail("where they touch one another, what would be left is no closed surface");
            left = std::move(*result);
        }
        return left;
    }

    /// Larger on every side by about so much, along each axis by another part of it, so that what touched does no more.
    static Mesh grown(Mesh tool, double by) {
        const CGAL::Bbox_3 box = processing::bbox(tool);
        const std::array<double, 3> share{1, 0.83, 1.19};
        const auto moved = [&](double x, int axis) {
            const double middle = (box.min(axis) + box.max(axis)) / 2, half = (box.max(axis) - box.min(axis)) / 2;
            return half > 0 ? x + by * share[static_cast<std::size_t>(axis)] * (x - middle) / half : x;
        };
        for (const Mesh::Vertex_index v : tool.vertices()) {
            const Kernel::Point_3& p = tool.point(v);
            tool.point(v) = Kernel::Point_3(moved(p.x(), 0), moved(p.y(), 1), moved(p.z(), 2));
        }
        return tool;
    }

    /// The one colour of all corners of a body, if there is one and no picture.
    struct Uniform {
        std::uint32_t material = 0;
        std::optional<Eigen::Vector4f> rgba;
    };
    std::optional<Uniform> colour_of(const TriangleRange& body) const {
        Uniform colour{parts_.material_of_triangle[body.first], {}};
        if (parts_.materials[colour.material].image >= 0) return std::nullopt;
        if (body.first < parts_.corner_rgba.size()) colour.rgba = parts_.corner_rgba[body.first][0];
        for (std::size_t t = body.first; t < body.last; ++t) {
            if (parts_.material_of_triangle[t] != colour.material) return std::nullopt;
            const bool has = t < parts_.corner_rgba.size();
            for (std::size_t c = 0; c < 3; ++c)
                if ((has ? parts_.corner_rgba[t][c] : Eigen::Vector4f::Ones().eval()) !=
                    colour.rgba.value_or(Eigen::Vector4f::Ones()))
                    return std::nullopt;
        }
        return colour;
    }

    void add(const TriangleRange& body, Mesh mesh) {
        const auto source = sources(mesh);
        const std::optional<Uniform> uniform = colour_of(body);
        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        for (const Mesh::Vertex_index v : mesh.vertices()) {
            const Kernel::Point_3& p = mesh.point(v);
            parts_.positions.emplace_back(p.x(), p.y(), p.z());
        }
        for (const Face face : mesh.faces()) {
            std::array<std::uint32_t, 3> corners{};
            std::size_t c = 0;
            for (const Mesh::Vertex_index v : vertices_around_face(mesh.halfedge(face), mesh))
                corners[c++] = first + static_cast<std::uint32_t>(v);
            if (source[face] >= 0)
                add_left(corners, static_cast<std::size_t>(source[face]));
            else
                add_wall(corners, uniform);
        }
    }

    /// A piece of triangle `from`.
    void add_left(const std::array<std::uint32_t, 3>& corners, std::size_t from) {
        const std::size_t t = parts_.add_triangle(corners, parts_.material_of_triangle[from]);
        std::array<Eigen::Vector3f, 3> weights;
        for (std::size_t c = 0; c < 3; ++c) weights[c] = weights_of(parts_.positions[corners[c]], from).cast<float>();
        const auto mixed = [&](const auto& values) {
            auto at = values;
            for (std::size_t c = 0; c < 3; ++c)
                at[c] = weights[c][0] * values[0] + weights[c][1] * values[1] + weights[c][2] * values[2];
            return at;
        };
        if (from < parts_.corner_uv.size()) parts_.set_uv(t, mixed(std::array(parts_.corner_uv[from])));
        if (from < parts_.corner_rgba.size()) parts_.set_rgba(t, mixed(std::array(parts_.corner_rgba[from])));
    }

    void add_wall(const std::array<std::uint32_t, 3>& corners, const std::optional<Uniform>& uniform) {
        const std::size_t t = parts_.add_triangle(corners, uniform ? uniform->material : 0);
        white_walls_ = white_walls_ || !uniform;
        if (uniform && uniform->rgba) parts_.set_rgba(t, {*uniform->rgba, *uniform->rgba, *uniform->rgba});
    }

    /// Barycentric, of the nearest point in the triangle's plane.
    Eigen::Vector3d weights_of(const Eigen::Vector3d& p, std::size_t t) const {
        const auto& corners = parts_.triangles[t];
        const Eigen::Vector3d& a = parts_.positions[corners[0]];
        Eigen::Matrix<double, 3, 2> edges;
        edges << parts_.positions[corners[1]] - a, parts_.positions[corners[2]] - a;
        const Eigen::Vector2d w = edges.colPivHouseholderQr().solve(p - a).cwiseMax(0).cwiseMin(1);
        return {std::max(0.0, 1 - w[0] - w[1]), w[0], w[1]};
    }

    /// Takes away what was replaced, and the vertices that nothing uses any more.
    void keep_rest(const std::vector<bool>& replaced) {
        constexpr std::uint32_t unused = 0xffffffff;
        std::vector<std::uint32_t> place(parts_.positions.size(), unused);
        std::vector<Eigen::Vector3d> positions;
        std::size_t kept = 0;
        if (!parts_.corner_uv.empty()) parts_.set_uv(0, std::array(parts_.corner_uv[0]));        // as long as there are
        if (!parts_.corner_rgba.empty()) parts_.set_rgba(0, std::array(parts_.corner_rgba[0]));  // triangles
        for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
            if (replaced[t]) continue;
            for (std::uint32_t& corner : parts_.triangles[t]) {
                if (place[corner] == unused) {
                    place[corner] = static_cast<std::uint32_t>(positions.size());
                    positions.push_back(parts_.positions[corner]);
                }
                corner = place[corner];
            }
            parts_.triangles[kept] = parts_.triangles[t];
            parts_.material_of_triangle[kept] = parts_.material_of_triangle[t];
            if (t < parts_.corner_uv.size()) parts_.corner_uv[kept] = parts_.corner_uv[t];
            if (t < parts_.corner_rgba.size()) parts_.corner_rgba[kept] = parts_.corner_rgba[t];
            ++kept;
        }
        parts_.positions = std::move(positions);
        parts_.triangles.resize(kept);
        parts_.material_of_triangle.resize(kept);
        if (!parts_.corner_uv.empty()) parts_.corner_uv.resize(kept);
        if (!parts_.corner_rgba.empty()) parts_.corner_rgba.resize(kept);
    }

    ModelParts& parts_;
    const std::string& model_;
    bool white_walls_ = false;
};

}  // namespace

void cut_volumes(ModelParts& parts, const std::vector<VolumeCut>& cuts, const std::string& model) {
    if (!cuts.empty()) Cutter(parts, model).cut(cuts);
}

}  // namespace voxtone::io
