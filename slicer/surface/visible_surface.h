// SPDX-License-Identifier: GPL-3.0-or-later
//
// The coloured surface: triangles from which colour is taken and depth is measured. Each knows which triangle of the
// textured mesh it lies on, and where.
//
// Where shells overlap or nest, what lies inside the body is hidden: it neither colours nor counts for depth. A point
// of the surface is hidden when the winding number is not zero on either side of it. Triangles are taken as a whole as
// far as they do not cross others; crossed ones are halved down to pieces of `piece_mm`, so the edge of what is visible
// is that rough.
//
// Triangles are in the order of where they lie, those of one place in the order of the mesh; but sheets (shells that
// enclose nothing) come first: of surfaces in one place the first gives the colour, and a sheet that lies on a body is
// a label. So it is the same surface however a file is ordered. People draw labels a little above their body, where a
// voxel would not see them: below `label_mm` they are laid onto it, for colour and depth.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/mesh_repair.h"
#include "slicer/mesh/spatial_index.h"

namespace voxtone::slicer {

struct VisibleSurface {
    std::vector<Eigen::Vector3d> positions_mm;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// Per triangle its triangle of the textured mesh.
    std::vector<std::uint32_t> source_triangle;
    /// Per triangle and corner the place in the source triangle: weights (u, v) of the source's corners 1 and 2; corner
    /// 0 has the rest, 1 - u - v.
    std::vector<std::array<Eigen::Vector2f, 3>> source_uv;
};

/// The coloured surface and the tree over it; made when the body is.
using SurfaceIndex = SpatialIndex<VisibleSurface>;

[[nodiscard]] double coloured_area_mm2(const VisibleSurface& surface);

struct VisibleSurfaceOptions {
    double piece_mm = 0.1;         ///< > 0
    double label_mm = 0;           ///< corners of sheets no farther from a body are laid onto it
    std::uint64_t most_steps = 0;  ///< of work (mesh/work_budget.h), for each of its parts; 0: by the triangles
};

struct VisibleSurfaceReport {
    std::size_t hidden = 0;   ///< triangles of the solid that are hidden as a whole
    std::size_t cut = 0;      ///< triangles of which a part is hidden
    std::size_t patches = 0;  ///< triangles made by the repair: each third has the colour of its corner
};

/// `positions_mm` and `triangles` are those of the textured mesh that was repaired.
/// Patches that fill holes take their colours from the corners; wraps leave colour and depth to the faces they stand
/// for, where these are within a few offsets of the wrap.
/// The work is bounded (mesh/work_budget.h): where triangles lie in one another by the thousand pieces grow, with a
/// warning, and at last InputError is thrown. `progress` advances by at most two steps for each triangle of the solid.
/// Throws Cancelled.
[[nodiscard]] VisibleSurface find_visible_surface(const std::vector<Eigen::Vector3d>& positions_mm,
                                                  const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                                  const RepairedMesh& repaired,
                                                  const VisibleSurfaceOptions& options = {},
                                                  VisibleSurfaceReport* report = nullptr, Progress* progress = nullptr);

}  // namespace voxtone::slicer
