// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary glTF 2.0 (Khronos Group, glTF 2.0 specification, 2021) of a mesh with vertex colours, for viewers.
//
// glTF is in metres with y up: (x, y, z) mm -> (x, z, -y) / 1000, a rotation, so that orientation and handedness stay.
// COLOR_0 is linear (specification 3.9.2), here 16 bit per channel: steps of 2^-16. The material is unlit
// (KHR_materials_unlit), white and two-sided: a viewer shows the vertex colours and nothing else.
//
// Or it is lit, for those who set a print among other things: the vertex colours are the base colour of a dielectric of
// the print's roughness and index (KHR_materials_ior), with normals (weighted by the angles of triangles). How light
// goes on within is told as KHR_materials_volume has it; viewers heed it where they let light through
// (KHR_materials_transmission, here 0: the colours hold what comes out of the resin already).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "io/models/coloured_mesh.h"

namespace voxtone::io {

struct LitMaterial {
    double roughness = 0;  ///< as glTF has it: the root of alpha of GGX; in [0, 1]
    double eta = 1.5;      ///< >= 1
    // Of the volume behind the surface:
    double thickness_mm = 0;                           ///< > 0
    std::array<double, 3> transmitted_by_mm{1, 1, 1};  ///< linear sRGB, of 1 mm; in (0, 1]
};

/// The bytes of the file; `name` is that of the mesh. The same mesh gives the same bytes. At least one triangle, finite
/// positions. Throws InputError when it would be larger than the 4 GiB that the format can hold.
[[nodiscard]] std::vector<std::uint8_t> glb_bytes(const ColouredMesh& mesh, std::string_view name,
                                                  const std::optional<LitMaterial>& lit = {});

}  // namespace voxtone::io
