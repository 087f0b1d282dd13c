// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body's visible surface in pieces of equal area, taken at random places: to count how much of it lies somewhere, or
// looks like something. A count of n pieces is off by the root of n.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "io/models/mesh.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

struct AreaPoint {
    Eigen::Vector3d at_mm, normal;  ///< outward, of unit length
    bool white;                     ///< every channel of linear light is 0.9 or more
};

/// 50,000 of them, the same every time; none of an empty surface. `mesh`: the surface's source.
[[nodiscard]] std::vector<AreaPoint> area_points(const VisibleSurface& surface, const io::TexturedMesh& mesh);

}  // namespace voxtone::slicer
