// SPDX-License-Identifier: GPL-3.0-or-later
//
// A light path at the surface of a body that may be rough: Fresnel's equations at the facets that it meets
// (rough_interface.h), about the shading normal, or about the geometric one where the shading normal would send it to
// the wrong side. Exact for smooth surfaces as boundary.h says; energy is kept in any case.
#pragma once

#include "optics/monte_carlo/path_random.h"
#include "optics/scene/boundary.h"

namespace voxtone::optics {

/// Turns `direction` (unit length; in the resin where `inside`, else in air) into that of the ray that goes on. True
/// where it went through the surface.
bool cross_boundary(const BoundaryNormals& normals, double eta, double roughness, bool inside, Point& direction,
                    PathRandom& random);

}  // namespace voxtone::optics
