// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/picture_slab.h"

#include <algorithm>

#include "base/contracts.h"
#include "base/error.h"
#include "base/units.h"

namespace voxtone::slicer {

namespace {

double width_of(const io::Picture& picture, const PictureOptions& options) {
    const double aspect = picture.pixel_aspect * picture.height_px / picture.width_px;
    if (options.width_mm > 0) return options.width_mm;
    if (options.height_mm > 0) return options.height_mm / aspect;
    if (options.dpi > 0) return picture.width_px / options.dpi * mm_per_inch;
    if (options.size_mm > 0) return options.size_mm / std::max(1.0, aspect);
    if (picture.dpi_x > 0) return picture.width_px / picture.dpi_x * mm_per_inch;
    throw UsageError(
        "the picture says nothing about its size; give --width, --height, --size or --dpi, such as --width 40mm");
}

}  // namespace

bool is_sized(const PictureOptions& options) {
    return options.width_mm > 0 || options.height_mm > 0 || options.dpi > 0 || options.size_mm > 0;
}

PictureSlab make_picture_slab(const io::Picture& picture, const PictureOptions& options) {
    const double thickness_mm = options.thickness_mm;
    VOXTONE_EXPECT(picture.width_px > 0 && picture.height_px > 0 && thickness_mm > 0);
    const double width_mm = width_of(picture, options);
    const double height_mm = width_mm * picture.height_px / picture.width_px * picture.pixel_aspect;

    PictureSlab slab;
    slab.model.format = "picture";
    slab.model.mm_per_file_unit = 1;
    slab.model.has_colour = true;
    slab.model.warnings = picture.warnings;
    slab.model.lost_colour = picture.lost_colour;
    io::TexturedMesh& mesh = slab.model.mesh;
    for (const double z : {0.0, thickness_mm})
        for (const double y : {0.0, height_mm})
            for (const double x : {0.0, width_mm}) mesh.positions.emplace_back(x, y, z);
    mesh.triangles = {{4, 5, 7}, {4, 7, 6},                        // top
                      {0, 3, 1}, {0, 2, 3}, {0, 1, 5}, {0, 5, 4},  // bottom, front
                      {1, 3, 7}, {1, 7, 5}, {3, 2, 6}, {3, 6, 7},  // right, back
                      {2, 0, 4}, {2, 4, 6}};                       // left
    mesh.materials.resize(2);
    mesh.materials[0] = {"picture", Eigen::Vector3f::Ones(), picture.texture};
    mesh.materials[1].name = "sides";
    mesh.material_of_triangle.assign(mesh.triangles.size(), 1);
    mesh.corner_uv.assign(mesh.triangles.size(),
                          {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()});
    const Eigen::Vector2f a(0, 0), b(1, 0), c(1, 1), d(0, 1);
    mesh.corner_uv[0] = {a, b, c};
    mesh.corner_uv[1] = {a, c, d};
    for (std::size_t t = 0; t < PictureSlab::top_triangles; ++t) mesh.material_of_triangle[t] = 0;
    return slab;
}

}  // namespace voxtone::slicer
