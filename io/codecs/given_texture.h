// SPDX-License-Identifier: GPL-3.0-or-later
//
// A texture that the user gives to a mesh that has texture coordinates and no picture of its own for them.
#pragma once

#include <filesystem>

#include "io/codecs/parse_context.h"
#include "io/models/model_parts.h"

namespace voxtone::io {

/// Lays the picture on every material that has none, as it is: material and corner colours do not multiply it. Where
/// the file names a picture that was not found or could not be read, this one takes its place. Pictures that the file
/// has stay. Throws InputError where there are no coordinates or no material without a picture, FileError.
void lay_given_texture(ModelParts& parts, ParseContext& context, const std::filesystem::path& texture);

}  // namespace voxtone::io
