// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wavefront OBJ with its material libraries (mtl_library.h).
//
// Colour of a face: its material's texture; where it has none, or the face no coordinates for it, colours of its
// vertices; where it has none of them, Kd. They are never multiplied; what a face has besides is left aside, which is
// said. Vertex colours are sRGB, written behind the place (`v x y z r g b`, with a weight before or an alpha behind
// them) or as ZBrush's #MRGB blocks, of 0 to 1 or another range (colour_range.h). Vertices without a colour beside
// others that have one, and without a Kd, are white and lost. A texture may be cut into tiles (udim.h).
//
// Numbers are double. Names of libraries, textures and materials may be quoted, have blanks and comments behind them
// and other upper and lower case. Points, lines and free-form surfaces are left aside, which is said.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_obj(ParseContext& context);

}  // namespace voxtone::io
