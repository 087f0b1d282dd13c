// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/face_sides.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "io/pictures/texture.h"
#include "slicer/mesh/triangle_tree.h"
#include "slicer/mesh/winding_number.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

constexpr double beside_mm = 1e-5;  // how far beside a face its sides are looked at

/// A face by its corners in ascending order.
struct SidedFace {
    Triangle corners;
    bool same_way;  ///< it goes round them in this order
    std::int32_t source;
};

SidedFace sided(const Triangle& t, std::int32_t source) {
    Triangle corners = t;
    std::sort(corners.begin(), corners.end());
    const auto begin = static_cast<std::size_t>(std::find(t.begin(), t.end(), corners[0]) - t.begin());
    return {corners, t[(begin + 1) % 3] == corners[1], source};
}

/// By corners, then as the file has them.
std::vector<SidedFace> sided_faces(std::span<const PiledFace> piled) {
    std::vector<SidedFace> faces;
    for (const PiledFace& face : piled)
        if (!collapsed(face.corners)) faces.push_back(sided(face.corners, face.source));
    std::sort(faces.begin(), faces.end(), [](const SidedFace& a, const SidedFace& b) {
        return std::tie(a.corners, a.source) < std::tie(b.corners, b.source);
    });
    return faces;
}

struct ByCorners {
    bool operator()(const SidedFace& a, const Triangle& b) const { return a.corners < b; }
    bool operator()(const Triangle& a, const SidedFace& b) const { return a < b.corners; }
};

/// Whether the body lies before the face and nothing behind it.
bool looks_inward(const TriangleTree& tree, std::uint32_t t) {
    const auto [a, b, c] = tree.corners(t);
    const Vector3d normal = (b - a).cross(c - a);
    if (!(normal.norm() > 0)) return false;
    const Vector3d middle = (a + b + c) / 3, step = beside_mm * normal.normalized();
    return winding_number(tree, middle + step) != 0 && winding_number(tree, middle - step) == 0;
}

/// Corner of triangle b where corner c of a is; 3: none.
std::size_t corner_at(const io::TexturedMesh& mesh, std::size_t a, std::size_t c, std::size_t b) {
    std::size_t at = 0;
    while (at < 3 && mesh.positions[mesh.triangles[b][at]] != mesh.positions[mesh.triangles[a][c]]) ++at;
    return at;
}

bool same_picture(const io::SurfaceMaterial& a, const io::SurfaceMaterial& b) {
    if (!a.texture || !b.texture) return !a.texture && !b.texture;
    return a.texture->pyramid() == b.texture->pyramid();
}

bool same_colour(const io::TexturedMesh& mesh, std::size_t a, std::size_t b) {
    const io::SurfaceMaterial &of_a = mesh.materials[mesh.material_of_triangle[a]],
                              &of_b = mesh.materials[mesh.material_of_triangle[b]];
    if (of_a.rgb != of_b.rgb || of_a.alpha != of_b.alpha || !same_picture(of_a, of_b)) return false;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t d = corner_at(mesh, a, c, b);
        if (d == 3) continue;
        if (!mesh.corner_rgb.empty() && mesh.corner_rgb[a][c] != mesh.corner_rgb[b][d]) return false;
        if (!mesh.corner_alpha.empty() && mesh.corner_alpha[a][c] != mesh.corner_alpha[b][d]) return false;
        if (of_a.texture && !mesh.corner_uv.empty() && mesh.corner_uv[a][c] != mesh.corner_uv[b][d]) return false;
    }
    return true;
}

}  // namespace

void take_outward_sources(SolidMesh& mesh, std::span<const PiledFace> piled) {
    const std::vector<SidedFace> faces = sided_faces(piled);
    if (faces.empty()) return;
    const TriangleTree tree(mesh.positions_mm, mesh.triangles);
    parallel_for(0, mesh.triangles.size(), 64, [&](std::size_t t) {
        if (mesh.source_triangle[t] < 0 || collapsed(mesh.triangles[t])) return;
        const SidedFace mine = sided(mesh.triangles[t], 0);
        const auto [first, last] = std::equal_range(faces.begin(), faces.end(), mine.corners, ByCorners());
        if (first == last) return;
        const bool turned = looks_inward(tree, static_cast<std::uint32_t>(t));
        const auto outward =
            std::find_if(first, last, [&](const SidedFace& f) { return f.same_way == (mine.same_way != turned); });
        if (outward != last) mesh.source_triangle[t] = outward->source;
    });
}

std::size_t count_other_colours(const io::TexturedMesh& textured, std::span<const PiledFace> piled) {
    const std::vector<SidedFace> faces = sided_faces(piled);
    std::size_t others = 0;
    if (textured.material_of_triangle.size() != textured.triangles.size()) return others;
    for (std::size_t n = 0, first = 0; n < faces.size(); ++n) {
        if (faces[n].corners != faces[first].corners) first = n;
        others += n != first && !same_colour(textured, static_cast<std::size_t>(faces[first].source),
                                             static_cast<std::size_t>(faces[n].source));
    }
    return others;
}

}  // namespace voxtone::slicer
