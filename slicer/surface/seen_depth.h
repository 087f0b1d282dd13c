// SPDX-License-Identifier: GPL-3.0-or-later
//
// How deep below a rectangle a body begins, on a grid of points: triangles are drawn one after the other and the
// nearest kept (a z-buffer). What lies above the rectangle counts too, with depths below 0.
#pragma once

#include "io/models/decal.h"
#include "slicer/mesh/solid_mesh.h"
#include "slicer/surface/mark_frame.h"

namespace voxtone::slicer {

/// At points no farther apart than `spacing_mm`, and no more than 4,096 along each side; the corners are among them.
[[nodiscard]] io::DepthMap depth_below(const MarkFrame& frame, const SolidMesh& body, double spacing_mm);

}  // namespace voxtone::slicer
