// SPDX-License-Identifier: GPL-3.0-or-later
//
// PLY and STL. assimp gives geometry, texture coordinates and vertex colours; what is colour beside them is read here:
// the header of PLY (types, declared sizes) and the attribute words of STL.
#pragma once

#include <string>

#include "voxtone/io/codecs/parse_context.h"

namespace voxtone::io {

/// `extension`: "ply" or "stl".
[[nodiscard]] ModelParts parse_with_assimp(ParseContext& context, const std::string& extension);

}  // namespace voxtone::io
