// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary little-endian PLY of a mesh with vertex colours: x, y, z in mm as float, z up; red, green, blue as 8-bit sRGB
// codes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/models/coloured_mesh.h"

namespace voxtone::io {

/// Further numbers of each vertex, as float properties of these names: `names.size()` values a vertex.
struct VertexNumbers {
    std::vector<std::string> names;
    std::vector<float> values;
};

/// The bytes of the file. The same mesh gives the same bytes.
[[nodiscard]] std::vector<std::uint8_t> ply_bytes(const ColouredMesh& mesh, const VertexNumbers& numbers = {});

}  // namespace voxtone::io
