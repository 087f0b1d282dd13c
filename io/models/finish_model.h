// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the plain parts of a parsed file to a checked mesh with textures that can be sampled.
#pragma once

#include <string>

#include "io/models/mesh.h"
#include "io/models/model_parts.h"

namespace voxtone::io {

/// Checks indices and values, welds positions, prepares textures; `fill_gutters`: texels that no triangle uses take the
/// colour of the nearest used one. `name` is for messages. Throws InputError.
[[nodiscard]] ModelFile finish_model(ModelParts parts, const std::string& name, bool fill_gutters);

}  // namespace voxtone::io
