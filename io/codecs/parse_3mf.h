// SPDX-License-Identifier: GPL-3.0-or-later
//
// 3MF packages: build items, components and transforms laid out; properties of triangles resolved to colours and
// textures.
//
// Why not lib3mf (Debian 12 has 1.8.1): it has no composites and no multiproperties, reads no beam lattice, so that its
// loss could not even be told, and believes sizes. It is the second opinion in the tests.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_3mf(ParseContext& context);

}  // namespace voxtone::io
