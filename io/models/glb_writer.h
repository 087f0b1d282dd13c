// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary glTF 2.0 (Khronos Group, glTF 2.0 specification, 2021) of a mesh with vertex colours, for viewers.
//
// glTF is in metres with y up: (x, y, z) mm -> (x, z, -y) / 1000, a rotation, so that orientation and handedness stay.
// COLOR_0 is linear (specification 3.9.2), here 16 bit per channel: steps of 2^-16. The material is unlit
// (KHR_materials_unlit), white and two-sided: a viewer shows the vertex colours and nothing else.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "voxtone/io/models/coloured_mesh.h"

namespace voxtone::io {

/// The bytes of the file; `name` is that of the mesh. The same mesh gives the same bytes. At least one triangle, finite
/// positions. Throws InputError when it would be larger than the 4 GiB that the format can hold.
[[nodiscard]] std::vector<std::uint8_t> glb_bytes(const ColouredMesh& mesh, std::string_view name);

}  // namespace voxtone::io
