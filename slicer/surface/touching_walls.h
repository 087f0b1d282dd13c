// SPDX-License-Identifier: GPL-3.0-or-later
//
// Walls of bodies that lie side by side in one print, nearer than a voxel: no voxel of air is between them, so they are
// neither seen nor coloured, whatever the meshes say.
#pragma once

#include <cstdint>
#include <span>

#include "slicer/mesh/triangle_tree.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// One of the bodies of a surface: a closed chain, and which triangles of the textured mesh are its own.
struct BodyOfSurface {
    const TriangleTree* solid = nullptr;
    std::uint32_t first_source = 0, end_source = 0;
};

/// Takes off the surface what another body covers: where a step of `gap_mm` along the normal leads into that body.
/// Triangles that are covered in part are cut into pieces of `piece_mm`. Time: by the area that lies near others.
void drop_touching_walls(VisibleSurface& surface, std::span<const BodyOfSurface> bodies, double gap_mm,
                         double piece_mm = 0.1);

}  // namespace voxtone::slicer
