// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a parser of one format delivers: plain values, nothing checked, nothing shared. It is what crosses the wall
// between the process that parses and the one that prints; `finish_model` makes a ModelFile of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "io/files/packed_values.h"
#include "io/models/side_file.h"
#include "io/pictures/decoded_image.h"
#include "io/pictures/texture.h"

namespace voxtone::io {

struct PartMaterial {
    std::string name;
    Eigen::Vector3f rgb = Eigen::Vector3f::Ones();  ///< linear sRGB
    float alpha = 1;
    bool opaque = false;                              ///< the format says that alpha is not to be looked at
    Eigen::Vector3f under = Eigen::Vector3f::Ones();  ///< linear; what shows through where the texture is transparent
    std::int32_t image = -1;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;
    bool glass = false;  ///< the format says that light goes through the body, which a print of it does not let
    float through = 0;   ///< what share of it, unscattered, where the format says so; in [0, 1]
    std::int32_t through_image = -1;  ///< times its red, at the coordinates of `image`; read where alpha is kept
    float within = 0;                 ///< translucency alpha of what that light goes through
    bool alpha_of_lengths = false;    ///< alpha comes of how far light gets in the body, a length of the file
    Eigen::Vector3f tint = Eigen::Vector3f::Ones();  ///< that it takes on there, linear
};

struct ModelParts {
    std::string format;
    double mm_per_file_unit = 0;
    bool has_colour = false;
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> material_of_triangle;
    std::vector<std::array<Eigen::Vector2f, 3>> corner_uv;    ///< per triangle; texture transforms applied; or empty
    std::vector<std::array<Eigen::Vector4f, 3>> corner_rgba;  ///< per triangle, linear; or empty
    std::vector<PartMaterial> materials;
    std::vector<DecodedImage> images;
    std::vector<std::string> image_names;
    std::vector<std::string> warnings, notes;
    std::vector<SideFile> side_files;
    /// What is in the file and will not be seen on the print, in whole sentences: colours, and textures by name, which
    /// a picture that the user gives may stand in for.
    std::vector<std::string> lost_colours, lost_textures;

    void lose_colour(std::string sentence) { say_once(lost_colours, std::move(sentence)); }
    void lose_texture(std::string sentence) { say_once(lost_textures, std::move(sentence)); }

    /// Appends a triangle without attributes; returns its index.
    std::size_t add_triangle(const std::array<std::uint32_t, 3>& corners, std::uint32_t material) {
        triangles.push_back(corners);
        material_of_triangle.push_back(material);
        return triangles.size() - 1;
    }
    /// Attributes of triangle t; triangles that have none get (0, 0) and white.
    void set_uv(std::size_t t, const std::array<Eigen::Vector2f, 3>& uv) {
        corner_uv.resize(triangles.size(), {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()});
        corner_uv[t] = uv;
    }
    void set_rgba(std::size_t t, const std::array<Eigen::Vector4f, 3>& rgba) {
        corner_rgba.resize(triangles.size(),
                           {Eigen::Vector4f::Ones(), Eigen::Vector4f::Ones(), Eigen::Vector4f::Ones()});
        corner_rgba[t] = rgba;
    }

private:
    static void say_once(std::vector<std::string>& said, std::string sentence) {
        if (std::find(said.begin(), said.end(), sentence) == said.end()) said.push_back(std::move(sentence));
    }
};

class PackedReader;

/// To bytes and back, on one machine. What comes back is not believed: unpacking throws InputError when the bytes are
/// cut short, or are no model or picture whose parts fit together.
[[nodiscard]] std::vector<std::byte> pack(const ModelParts& parts);
[[nodiscard]] Packing packing_of(ModelParts parts);
[[nodiscard]] ModelParts unpack_model(std::span<const std::byte> bytes);
[[nodiscard]] ModelParts unpack_model(PackedReader& reader);

}  // namespace voxtone::io
