// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where on a flat map a point of a model's surface lies: for each triangle of the textured mesh an affine function of
// the place (u, v) in it, in mm of the map from its lower left corner.
//
// By texture coordinates: the unit square is the map, and repeats.
// By box: the point is projected along the dominant axis of its triangle's normal, in mm of the print, onto a map that
// stands upright and readable on each of the six sides of the model's bounding box, its lower left corner in theirs,
// and beyond its edges is mirrored. On triangles that meet where the axis changes the map jumps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "io/models/mesh.h"

namespace voxtone::scattering {

class MapPlacement {
public:
    /// Throws InputError for a mesh without texture coordinates.
    [[nodiscard]] static MapPlacement by_texture(const io::TexturedMesh& mesh, double map_width_mm,
                                                 double map_height_mm);
    /// Positions in mm.
    [[nodiscard]] static MapPlacement by_box(const io::TexturedMesh& mesh);

    /// The point corner0 + u (corner1 - corner0) + v (corner2 - corner0) of a triangle of the mesh.
    [[nodiscard]] Eigen::Vector2f at(std::uint32_t triangle, float u, float v) const {
        const auto& [origin, along_u, along_v] = frame_[triangle];
        return origin + u * along_u + v * along_v;
    }

private:
    std::vector<std::array<Eigen::Vector2f, 3>> frame_;
};

}  // namespace voxtone::scattering
