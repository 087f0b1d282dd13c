// SPDX-License-Identifier: GPL-3.0-or-later
//
// The flattest place of a body for a rectangle: from each of several sides the body's depths are drawn, and of all
// places where the rectangle lies on the body as a whole, with no step or edge below it and nowhere steeper than 50
// degrees, the one whose depths differ least is taken; of equally flat ones that of the largest face, near its middle.
// Depths are looked at every 0.1 mm, or on 600 points along the longer side where that is coarser.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "slicer/mesh/solid_mesh.h"
#include "slicer/surface/mark_frame.h"

namespace voxtone::slicer {

/// The six sides and the directions in which most of the surface faces; earlier ones first where all else is equal.
[[nodiscard]] std::vector<Eigen::Vector3d> facing_directions(const SolidMesh& body);

struct FlatQuery {
    double width_mm, height_mm;
    double turn_deg = 0;               ///< against upright
    std::span<const MarkFrame> taken;  ///< rectangles to keep clear of
    double most_uneven_mm = std::numeric_limits<double>::infinity();
};

/// Nothing: no place is as large and even.
[[nodiscard]] std::optional<MarkFrame> flattest_place(const SolidMesh& body, std::span<const Eigen::Vector3d> outs,
                                                      const FlatQuery& query);

/// On the first of these sides that has a place as large and nearly flat, where that is flattest.
[[nodiscard]] std::optional<MarkFrame> first_flat_place(const SolidMesh& body,
                                                        std::span<const std::vector<Eigen::Vector3d>> sides,
                                                        FlatQuery query);

}  // namespace voxtone::slicer
