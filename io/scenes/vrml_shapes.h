// SPDX-License-Identifier: GPL-3.0-or-later
//
// The geometry nodes of VRML97 (ISO/IEC 14772-1:1997, clause 6) as polygons: IndexedFaceSet, ElevationGrid, Box, and
// Cone, Cylinder and Sphere of 96 segments, a two-thousandth of the radius off the round. Texture coordinates as the
// standard lays them where the file gives none: of faces along the two longest sides of what bounds them, of grids
// over the whole, of simple shapes as their clauses draw it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/scenes/vrml_tree.h"

namespace voxtone::io {

/// What a polygon's corner shows; from 0, -1: nothing.
struct VrmlCorner {
    std::int32_t point = 0, uv = -1, colour = -1;
};

struct VrmlFaces {
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector2f> uv;
    std::vector<Eigen::Vector3f> colours;  ///< sRGB codes
    std::vector<VrmlCorner> corners;       ///< polygon by polygon, counterclockwise from outside
    std::vector<std::size_t> ends;         ///< of the polygons among the corners; three each at least
    bool by_count = false;                 ///< colours are those of faces by their number, not as the file says
    std::size_t uncoloured = 0, unlaid = 0, thin = 0;  ///< corners without what others have; polygons of two corners
};

/// Whether it is one of these.
[[nodiscard]] bool is_vrml_shape(std::string_view type);

/// Every index of a polygon is one of its list. Throws InputError naming `file` and the line.
[[nodiscard]] VrmlFaces vrml_faces(const VrmlScene& scene, const VrmlNode& geometry, const std::string& file);

}  // namespace voxtone::io
