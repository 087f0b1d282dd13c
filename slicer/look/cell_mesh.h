// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface cells of a voxel body as a mesh with exactly one vertex per cell, at the middle of the cell's faces: what
// a model says of a cell is the colour of a vertex, and a viewer shows it smoothly.
//
// Method (the dual of the cells' own surface; after S. F. F. Gibson, "Constrained elastic surface nets", 1998): cells
// that hold resin are solid. Round each corner of the grid the faces between solid and empty cells form rings; each
// ring becomes a polygon through the cells that own its faces, seen counter-clockwise from outside. Where two solid
// cells touch along an edge alone they stay apart. Faces that the surface leaves out (on a sheet) leave a hole. Cells
// whose faces lie behind those of other cells have a vertex and no triangle. Error: sharp edges are cut by up to half a
// cell; walls thinner than a cell become one sheet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "optics/scene/appearance_model.h"

namespace voxtone::slicer {

/// Triangles whose corners are numbers of cells of the surface (SurfacePart::all of this volume).
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> cell_triangles(const optics::ResinVolume& volume,
                                                                       const optics::Surface& surface);

}  // namespace voxtone::slicer
