// SPDX-License-Identifier: GPL-3.0-or-later
//
// glTF 2.0 and GLB: scene, nodes, triangles, base colours. Read here and not by a library, because the libraries at
// hand lose or rewrite what decides the colour (texture transforms, alpha modes, the second set of coordinates) and do
// not say what they left out. Based on: Khronos Group, "glTF 2.0 Specification", version 2.0.1, 2021; extension
// KHR_texture_transform.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_gltf(ParseContext& context);

}  // namespace voxtone::io
