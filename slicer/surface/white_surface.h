// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether anything but white will be seen of a surface.
#pragma once

#include "io/models/mesh.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// True where every colour that was asked for is white: within half a percent of 1 in each channel of linear sRGB,
/// looked at in the middle of every triangle and at 80,000 points spread over the area, each for the mean over what a
/// twenty-thousandth of the area is. What colours less than that can be missed. Positions of `mesh` in mm.
[[nodiscard]] bool is_all_white(const io::TexturedMesh& mesh, const VisibleSurface& surface);

}  // namespace voxtone::slicer
