// SPDX-License-Identifier: GPL-3.0-or-later
//
// Walls and rods that may break: where the body is thinner than the printer's maker asks for.
//
// From points all over the visible surface a line goes straight inward. Where it leaves the body again nearer than the
// limit, through a face that looks away by more than 150 degrees (an edge of a thick body is no wall, sharp as it may
// be), the body is thin there; where another piece begins at once behind that face, it is not. What stands out of a
// thick body by less than it is thick (a stripe, a frame) does not break. Points that lie near each other are one
// place, told if it is longer than twice the limit, or than half a small body: the tips of cones and the edges of
// blades are thin on any print, and do no harm.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/spatial_index.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

struct ThinWall {
    double thickness_mm = 0;                              ///< median of its points
    double length_mm = 0;                                 ///< diagonal of its box
    Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< of its box
    std::uint32_t source_triangle = 0;                    ///< of one of its points, in the textured mesh
};

/// The longest first. `solid`: closed. Points lie `limit_mm` / 3 apart on average, on large bodies farther. Throws
/// Cancelled.
[[nodiscard]] std::vector<ThinWall> find_thin_walls(const VisibleSurface& surface, const SolidIndex& solid,
                                                    double limit_mm, const Progress& progress);

/// How many times as large the body must be for none to be told, of 1.25, 1.5, 2, 3 and 4 the first that is enough:
/// looked for, as what tapers has a thin end at any size. Nothing where none is.
[[nodiscard]] std::optional<double> larger_without_thin_walls(const VisibleSurface& surface, const SolidIndex& solid,
                                                              double limit_mm, const Progress& progress);

/// Where pieces of a body meet in a point or along an edge alone and nothing else holds them together: the middle of
/// what they share. Two pieces are held where their boxes overlap by the limit along all axes, or where they share a
/// face.
[[nodiscard]] std::vector<Eigen::Vector3d> bare_joints(const SolidMesh& solid, double limit_mm);

}  // namespace voxtone::slicer
