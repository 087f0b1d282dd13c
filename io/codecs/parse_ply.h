// SPDX-License-Identifier: GPL-3.0-or-later
//
// PLY, text and binary of either byte order: faces and triangle strips, colours of vertices and of faces, texture
// coordinates of vertices and of faces' corners, several texture files by `texnumber`.
//
// Colours are sRGB codes; their range is that of colour_range.h. Signed integers that are negative are meant to be
// unsigned. Colours of an element "material" count where vertices and faces have none, by `material_index`.
// Textures come before colours, which are not multiplied; colours of faces count where those of vertices are all alike.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_ply(ParseContext& context);

}  // namespace voxtone::io
