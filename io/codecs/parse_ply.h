// SPDX-License-Identifier: GPL-3.0-or-later
//
// PLY, text and binary of either byte order: faces and triangle strips, colours of vertices and of faces, texture
// coordinates of vertices and of faces' corners, several texture files by `texnumber`.
//
// Colours are sRGB codes. Their range goes by type and by what occurs: of 0 to 255 for bytes; for wider integers 0 to
// 255 where none is larger, else the whole range of 16 or 32 bits; for floats 0 to 1, or 0 to 255 where one is
// above 1.5. Signed integers that are negative are meant to be unsigned. What is not bytes or floats of 0 to 1 is said.
// Textures come before colours, which are not multiplied; colours of faces count where those of vertices are all alike.
#pragma once

#include "voxtone/io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_ply(ParseContext& context);

}  // namespace voxtone::io
