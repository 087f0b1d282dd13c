// SPDX-License-Identifier: GPL-3.0-or-later
//
// OBJ, PLY and STL. assimp gives geometry, texture coordinates and vertex colours; what is colour beside them is read
// here: material libraries (assimp knows few options and invents defaults), the header of PLY (types, declared sizes)
// and the attribute words of STL.
#pragma once

#include <string>

#include "voxtone/io/codecs/parse_context.h"

namespace voxtone::io {

/// `extension`: "obj", "ply" or "stl".
[[nodiscard]] ModelParts parse_with_assimp(ParseContext& context, const std::string& extension);

}  // namespace voxtone::io
