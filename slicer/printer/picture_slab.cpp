// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/picture_slab.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/counted.h"
#include "base/error.h"
#include "base/units.h"
#include "slicer/mesh/disjoint_sets.h"
#include "slicer/printer/picture_outline.h"

namespace voxtone::slicer {

namespace {

/// Of a face of so many pixels. In a drawing's own size --dpi has had its say (io::DrawingRaster).
Eigen::Vector2d size_of(const io::Picture& picture, const Eigen::Vector2d& face_px, const PictureOptions& options) {
    const double aspect = picture.pixel_aspect * face_px.y() / face_px.x();
    const auto as_wide = [&](double mm) { return Eigen::Vector2d(mm, mm * aspect); };
    if (options.width_mm > 0) return as_wide(options.width_mm);
    if (options.height_mm > 0) return as_wide(options.height_mm / aspect);
    if (options.dpi > 0 && !picture.is_drawing) return as_wide(face_px.x() / options.dpi * mm_per_inch);
    if (options.size_mm > 0) return as_wide(options.size_mm / std::max(1.0, aspect));
    if (picture.dpi_x > 0) return as_wide(face_px.x() / picture.dpi_x * mm_per_inch);
    throw UsageError(
        "the picture says nothing about its size; give --width, --height, --size or --dpi above 0, such as --width "
        "40mm");
}

/// What of a picture is printed, in pixels from its upper left corner, y downwards.
struct Face {
    std::vector<Eigen::Vector2d> corners_px;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counterclockwise, seen with y downwards
    std::size_t outlines = 1;
    [[nodiscard]] Eigen::AlignedBox2d box() const {
        Eigen::AlignedBox2d box;
        for (const Eigen::Vector2d& corner : corners_px) box.extend(corner);
        return box;
    }
};

Face whole_face(const io::Picture& picture) {
    const double w = picture.width_px, h = picture.height_px;
    return {{{0, h}, {w, h}, {0, 0}, {w, 0}}, {{0, 3, 1}, {0, 2, 3}}, 1};
}

/// Pixels that are no smaller than this are too fine for any printer's voxels.
std::uint32_t step_of(const io::Picture& picture, const PictureOptions& options) {
    constexpr double finest_mm = 0.02;
    Eigen::AlignedBox2d opaque;
    for (std::size_t i = 0; i < picture.alpha.size(); ++i)
        if (picture.alpha[i] >= 32768) {
            const Eigen::Vector2d low(double(i % picture.width_px), double(i / picture.width_px));
            opaque.extend(low).extend(low + Eigen::Vector2d::Ones());
        }
    const Eigen::Vector2d px_mm = size_of(picture, opaque.sizes(), options).cwiseQuotient(opaque.sizes());
    return static_cast<std::uint32_t>(std::clamp(finest_mm / px_mm.maxCoeff(), 1.0, 1e3));
}

Face cut_face(const io::Picture& picture, const PictureOptions& options) {
    const std::vector<Outline> outlines =
        picture_outlines(picture.alpha, picture.width_px, picture.height_px, step_of(picture, options));
    Face face;
    face.outlines = outlines.size();
    for (const Outline& outline : outlines)
        face.corners_px.insert(face.corners_px.end(), outline.begin(), outline.end());
    face.triangles = outline_triangles(outlines);
    if (face.triangles.empty())
        throw InputError(
            "what is opaque of the picture is finer than 0.02 mm: nothing is left of it; give a larger "
            "--width");
    return face;
}

std::size_t pieces_of(const Face& face) {
    DisjointSets sets(face.corners_px.size());
    for (const auto& [a, b, c] : face.triangles) sets.unite(a, b), sets.unite(a, c);
    std::size_t pieces = 0;
    for (std::uint32_t v = 0; v < face.corners_px.size(); ++v) pieces += sets.root(v) == v ? 1 : 0;
    return pieces;
}

/// Edges that one triangle has and no other, in its sense of turning.
std::vector<std::array<std::uint32_t, 2>> rim_of(const Face& face) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const auto& t : face.triangles)
        for (std::size_t k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
    std::ranges::sort(edges);
    std::vector<std::array<std::uint32_t, 2>> rim;
    for (const auto& [a, b] : edges)
        if (!std::ranges::binary_search(edges, std::array{b, a})) rim.push_back({a, b});
    return rim;
}

void add_body(const Face& face, const Eigen::Vector2d& size_mm, double thickness_mm, io::TexturedMesh& mesh) {
    const Eigen::AlignedBox2d box = face.box();
    const auto n = static_cast<std::uint32_t>(face.corners_px.size());
    for (const double z : {0.0, thickness_mm})
        for (const Eigen::Vector2d& p : face.corners_px)
            mesh.positions.emplace_back((p.x() - box.min().x()) / box.sizes().x() * size_mm.x(),
                                        (box.max().y() - p.y()) / box.sizes().y() * size_mm.y(), z);
    // y points up in the print: triangles turn the other way.
    for (const auto& [a, b, c] : face.triangles) mesh.triangles.push_back({n + a, n + c, n + b});
    for (const auto& [a, b, c] : face.triangles) mesh.triangles.push_back({a, b, c});
    for (const auto& [a, b] : rim_of(face)) {
        mesh.triangles.push_back({b, a, n + a});
        mesh.triangles.push_back({b, n + a, n + b});
    }
}

}  // namespace

bool is_sized(const PictureOptions& options) {
    return options.width_mm > 0 || options.height_mm > 0 || options.dpi > 0 || options.size_mm > 0;
}

PictureSlab make_picture_slab(const io::Picture& picture, const PictureOptions& options) {
    VOXTONE_EXPECT(picture.width_px > 0 && picture.height_px > 0 && options.thickness_mm > 0);
    const bool is_cut = !picture.alpha.empty();
    const Face face = is_cut ? cut_face(picture, options) : whole_face(picture);

    PictureSlab slab;
    slab.model.format = "picture";
    slab.model.mm_per_file_unit = 1;
    slab.model.has_colour = true;
    slab.model.warnings = picture.warnings;
    slab.model.lost_colour = picture.lost_colour;
    io::TexturedMesh& mesh = slab.model.mesh;
    add_body(face, size_of(picture, face.box().sizes(), options), options.thickness_mm, mesh);
    mesh.materials.resize(2);
    mesh.materials[PictureSlab::face_material] = {"picture", Eigen::Vector3f::Ones(), picture.texture, 1,
                                                  picture.alpha_texture};
    mesh.materials[1].name = "sides";
    mesh.material_of_triangle.assign(mesh.triangles.size(), 1);
    mesh.corner_uv.assign(mesh.triangles.size(),
                          {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()});
    for (std::size_t t = 0; t < face.triangles.size(); ++t) {
        mesh.material_of_triangle[t] = PictureSlab::face_material;
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector2d& p = face.corners_px[mesh.triangles[t][k] - face.corners_px.size()];
            mesh.corner_uv[t][k] = {float(p.x() / picture.width_px), float(1 - p.y() / picture.height_px)};
        }
    }
    if (is_cut) {
        const std::size_t pieces = pieces_of(face);
        slab.notes.push_back(fmt::format("the picture is cut to shape: {} with {}", counted(pieces, "piece"),
                                         counted(face.outlines - pieces, "hole")));
    }
    return slab;
}

}  // namespace voxtone::slicer
