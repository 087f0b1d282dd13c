// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the plain parts of a parsed file to a checked mesh with textures that can be sampled.
#pragma once

#include <string>

#include "io/files/read_options.h"
#include "io/models/mesh.h"
#include "io/models/model_parts.h"

namespace voxtone::io {

struct FinishOptions {
    bool fill_gutters = true;  ///< texels that no triangle uses take the colour of the nearest used one
    TextureFilter filter = TextureFilter::as_file;
    bool keep_alpha = false;  ///< apart from colours; of pictures over a colour of the file's own it is composed
};

/// Checks indices and values, welds positions, prepares textures. `name` is for messages. Throws InputError.
[[nodiscard]] ModelFile finish_model(ModelParts parts, const std::string& name, const FinishOptions& options);

}  // namespace voxtone::io
