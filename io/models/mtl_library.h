// SPDX-License-Identifier: GPL-3.0-or-later
//
// Material libraries of OBJ files, as far as they are colour: newmtl, Kd, d, Tr, map_Kd (-o, -s, -clamp, -mm, names
// with spaces). Colours may be of 0 to 255 (colour_range.h). Where Kd says nothing, colour is taken from where unlit
// exporters put it: a map from map_Ke (Kd black or absent) or map_Ka (Kd grey or absent), a colour from Ke (Kd black or
// absent) or from a Ka that is no grey (likewise: many write a white Ka beside a Kd that is black and means it).
// They are sRGB codes, but for Blender's, which writes linear light (3.4.1: a grey of code 0.50 is Kd 0.2159).
// Everything else is passed over. No line of a library makes it invalid.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

struct MtlMaterial {
    std::string name;
    std::optional<Eigen::Vector3f> kd;  ///< in [0, 1]: sRGB codes, or linear light
    bool is_linear = false;
    std::string colour_from, map_from;  ///< "Ka", "map_Ke": where kd, map_kd were taken from instead; empty: themselves
    std::string unread_kd;              ///< where Kd is no three numbers: what it is ("spectral x.rfl 1")
    float opacity = 1;                  ///< d where it is given, else 1 - Tr
    bool has_dissolve = false;          ///< d is given
    std::string map_kd;                 ///< empty: none
    Eigen::Vector2f map_offset = Eigen::Vector2f::Zero(), map_scale = Eigen::Vector2f::Ones();
    bool map_clamp = false;
    float map_base = 0, map_gain = 1;  ///< -mm: a code c of the picture means base + gain c
    bool has_opacity_map = false;
    /// Statements map_... that are neither MTL's nor known as something else than colour, and their files.
    std::vector<std::pair<std::string, std::string>> unknown_maps;
};

/// Whether both look the same, by all that is read of them but their names.
[[nodiscard]] bool look_alike(const MtlMaterial& a, const MtlMaterial& b);

/// `text`: as model_text gives it.
[[nodiscard]] std::vector<MtlMaterial> parse_mtl(std::string_view text);

}  // namespace voxtone::io
