// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a GLB of a body shows from each of its six sides, read by nothing of the program's: glTF 2.0 binary container
// (Khronos Group, 2021, section 4.4), triangles with COLOR_0, axes turned back from y up to z up.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

namespace voxtone::test {

using Codes = std::array<int, 3>;  ///< sRGB, 0 to 255

struct GlbSides {
    std::array<double, 3> size_mm{};     ///< of the box around all triangles
    std::map<std::string, Codes> sides;  ///< "+x": the median over the area that lies in that side of the box
};

/// Throws std::runtime_error.
[[nodiscard]] GlbSides glb_sides(const std::filesystem::path& file);

}  // namespace voxtone::test
