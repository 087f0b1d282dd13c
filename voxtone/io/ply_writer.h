// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary little-endian PLY of a mesh with vertex colours: x, y, z in mm as float, z up; red, green, blue as 8-bit sRGB
// codes.
#pragma once

#include <cstdint>
#include <vector>

#include "voxtone/io/coloured_mesh.h"

namespace voxtone::io {

/// The bytes of the file. The same mesh gives the same bytes.
[[nodiscard]] std::vector<std::uint8_t> ply_bytes(const ColouredMesh& mesh);

}  // namespace voxtone::io
