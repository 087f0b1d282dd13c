// SPDX-License-Identifier: GPL-3.0-or-later
//
// A triangle mesh with its colour, as every reader delivers it.
//
// Colour of a surface point = material.rgb * corner colour (interpolated) * texture(uv)      (linear sRGB, per channel)
// where a factor that is absent counts as 1, and over that the decals, one after the other. Alpha is composed over
// white by the reader, which says so; or it is kept apart (ReadOptions::keep_alpha), a product of the same three
// factors.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/models/decal.h"

namespace voxtone::io {

class Texture;  // io/pictures/texture.h: decoded, gutters filled, filtered

struct SurfaceMaterial {
    std::string name;
    Eigen::Vector3f rgb = Eigen::Vector3f::Ones();  ///< linear sRGB
    std::shared_ptr<const Texture> texture;         ///< null: none
    float alpha = 1;                                ///< where it is kept
    std::shared_ptr<const Texture> alpha_texture;   ///< where it is kept: in each channel; null: 1 everywhere
    bool alpha_of_lengths = false;                  ///< the file says how far light gets, in its own unit
    double times_as_large = 1;                      ///< ... in a body printed so: it is to look as in the file
};

struct TexturedMesh {
    std::vector<Eigen::Vector3d> positions;  ///< in units of the file; all finite; welded where equal to the bit
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> material_of_triangle;  ///< one per triangle, an index into `materials`
    std::vector<std::array<Eigen::Vector2f, 3>>
        corner_uv;  ///< one per triangle, or empty; (0,0) is the texture's bottom left
    std::vector<std::array<Eigen::Vector3f, 3>> corner_rgb;  ///< one per triangle, linear sRGB factors, or empty
    std::vector<std::array<float, 3>> corner_alpha;          ///< one per triangle, or empty
    std::vector<SurfaceMaterial> materials;                  ///< at least one
    std::vector<Decal> decals;                               ///< in mm of positions; no reader delivers any
};

/// What a reader has to say beside the mesh.
struct ModelFile {
    TexturedMesh mesh;
    std::string format;                 ///< "OBJ", "3MF", ...
    double mm_per_file_unit = 0;        ///< from the file; 0 where the format has no unit
    bool has_colour = false;            ///< any texture, vertex or material colour in the file
    bool wants_colour = false;          ///< ... and some of it is not white
    std::vector<std::string> warnings;  ///< what was in the file and cannot be carried, in whole sentences
    std::string lost_colour;            ///< that of them which tells of lost colours; empty: none is lost
};

}  // namespace voxtone::io
