// SPDX-License-Identifier: GPL-3.0-or-later
//
// What of the alpha that is asked for no thickness of a print's resins can show: all of it looks as 1 does.
#pragma once

#include <string>

#include "halftone/separation/translucency.h"
#include "slicer/surface/surface_colour.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// A warning by name; empty where less than a hundredth of the surface asks for such an alpha. 1 means as opaque as it
/// goes, and asks for nothing else.
[[nodiscard]] std::string alpha_out_of_reach(const VisibleSurface& surface, const SurfaceColour& colour,
                                             const halftone::Translucency& translucency);

}  // namespace voxtone::slicer
