// SPDX-License-Identifier: GPL-3.0-or-later
//
// VRML 2 (VRML97, ISO/IEC 14772-1), also packed by gzip, as .wrz is: the polygons of its shapes
// (io/scenes/vrml_shapes.h) where its groups put them, turned from y up to z up. It names metres; files for printers
// are in mm, so that its unit counts as unknown.
//
// Colour of a face: its texture (ImageTexture: the first of its names that is there; PixelTexture), not multiplied, but
// for a PixelTexture of greys, which shades what lies below; where there is none, the colours of its vertices or of
// itself; else diffuseColor, or emissiveColor where that is black or absent. All are sRGB codes, as Kd of OBJ is.
//
// Of a Switch what it shows is taken, of levels of detail the first. Animations, lights and views are left aside,
// points, lines and flat text too, which is said. Other files (Inline), prototypes, extrusions and what the standard
// does not have refuse the file by name, as VRML 1.0 is.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_vrml(ParseContext& context);

}  // namespace voxtone::io
