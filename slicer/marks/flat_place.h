// SPDX-License-Identifier: GPL-3.0-or-later
//
// The flattest place of a body for a rectangle: from each of several sides the body's depths are drawn, and of all
// places where the rectangle lies on the body as a whole, with no step or edge below it and nowhere steeper than 50
// degrees, the one whose depths differ least is taken; of equally flat ones that of the largest face, near its middle.
// Depths are looked at every 0.1 mm, or on 600 points along the longer side where that is coarser.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slicer/marks/mark_frame.h"
#include "slicer/mesh/solid_mesh.h"

namespace voxtone::slicer {

/// The six sides and the directions in which most of the surface faces; earlier ones first where all else is equal.
[[nodiscard]] std::vector<Eigen::Vector3d> facing_directions(const SolidMesh& body);

/// A rectangle that is turned so much against upright. Nothing: no place is as large. `taken`: rectangles to keep clear
/// of.
[[nodiscard]] std::optional<MarkFrame> flattest_place(const SolidMesh& body, std::span<const Eigen::Vector3d> outs,
                                                      double width_mm, double height_mm, double turn_deg,
                                                      std::span<const MarkFrame> taken);

}  // namespace voxtone::slicer
