// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which of several faces in one place gives the colour: the first that looks out of the body, as its file drew it.
// Exporters of two-sided materials write every face twice, the back side with a material of its own, in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/models/mesh.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/solid_mesh.h"

namespace voxtone::slicer {

/// One of several faces on the same three corners.
struct PiledFace {
    Triangle corners;     ///< of the mesh, in the order in which the file goes round them
    std::int32_t source;  ///< its triangle of the textured mesh
};

/// Gives triangles of `mesh`, a closed chain, the source of the first of the piled faces in their place that looks
/// outward: to the side around which the mesh does not wind, or where both sides are alike, as the triangle does.
/// Triangles where there is no such face keep theirs.
void take_outward_sources(SolidMesh& mesh, std::span<const PiledFace> piled);

/// How many of the faces have another colour than the first in the same place, by material, texture coordinates and
/// colours of corners.
[[nodiscard]] std::size_t count_other_colours(const io::TexturedMesh& textured, std::span<const PiledFace> piled);

}  // namespace voxtone::slicer
