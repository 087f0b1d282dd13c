// SPDX-License-Identifier: GPL-3.0-or-later
//
// Material libraries of OBJ files, as far as they are colour: newmtl, Kd, d, Tr, map_Kd (-o, -s, -clamp, names with
// spaces). Everything else is passed over. No line of a library makes it invalid.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

struct MtlMaterial {
    std::string name;
    std::optional<Eigen::Vector3f> kd;  ///< sRGB codes in [0, 1]
    float opacity = 1;                  ///< d where it is given, else 1 - Tr
    bool has_dissolve = false;          ///< d is given
    std::string map_kd;                 ///< empty: none
    Eigen::Vector2f map_offset = Eigen::Vector2f::Zero(), map_scale = Eigen::Vector2f::Ones();
    bool map_clamp = false;
    bool has_opacity_map = false;
};

[[nodiscard]] std::vector<MtlMaterial> parse_mtl(std::string_view text);

}  // namespace voxtone::io
