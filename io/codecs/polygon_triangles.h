// SPDX-License-Identifier: GPL-3.0-or-later
//
// Polygons of any shape cut into triangles, without new corners: convex ones as fans, others by a constrained Delaunay
// triangulation of their outline (CGAL), in the plane that lies nearest to them (M. E. Newell's normal). Holes that are
// joined to the outline by a bridge come out as holes. Where an outline crosses itself it is cut as if it were convex,
// which closes a surface as well as any: what lies doubly within it cancels. Convex ones of more than 1,000 corners are
// halved again and again, as the slivers of a fan all lie at one corner. A convex quad that is not flat is cut along
// the diagonal at which it folds less.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

/// Triangles by corners of the polygon, in its sense of turning; at least three corners. `file` is what errors name.
/// `by_place`: where the corners lie decides how it is cut, and not which comes first, so that a polygon and its back
/// side are cut alike.
/// Throws InputError for one of more than 50,000 corners that is not convex, which would take more than some seconds.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> polygon_triangles(std::span<const Eigen::Vector3d> corners,
                                                                          std::string_view file = "a model",
                                                                          bool by_place = false);

}  // namespace voxtone::io
