// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture with alpha laid onto the surface of a mesh, over its colour: seen from a side, straight, like a slide that
// is projected onto it; or within a rectangle of the mesh's texture coordinates.
//
// From a side it covers what is seen from there: of all points behind one another the first, and of these only what is
// turned towards the projector, by less than acos(least_cos). What hides what is kept as a map of depths (L. Williams
// 1978, "Casting curved shadows on curved surfaces"), taken from the body; a point counts as the first where it lies no
// deeper than the deepest of the four depths around it and a slack.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "io/pictures/alpha_picture.h"

namespace voxtone::io {

/// Depths of what is first hit, on a grid of points over a rectangle; infinite where nothing is.
struct DepthMap {
    std::uint32_t columns = 0, rows = 0;  ///< at least 2 each, or 0: there is no map
    std::vector<float> depth_mm;          ///< rows from the bottom
    /// The deepest of the four around a place from 0 to 1 along both; infinite where all four are.
    [[nodiscard]] float deepest_near(float along, float up) const;
};

struct Decal {
    /// 75 degrees: beyond, a picture would be smeared to four times its length.
    static constexpr double least_cos = 0.2588;

    std::shared_ptr<const AlphaPicture> picture;
    double width_mm = 1, height_mm = 1;
    /// Lower left corner, unit vectors to the right, up and towards the viewer, in mm.
    Eigen::Vector3d corner_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::UnitX(), up = Eigen::Vector3d::UnitY(), out = Eigen::Vector3d::UnitZ();
    DepthMap first_hit;  ///< below the corner's plane, away from the viewer
    double slack_mm = 0.05;
    /// In texture coordinates instead: corner and size are in them, and nothing else counts.
    bool by_uv = false;

    /// What covers a point of a triangle: R, G, B times alpha, and alpha. `normal`: of the triangle, unit length,
    /// either way. `sample_spacing_mm`: how far apart points are asked for.
    [[nodiscard]] Eigen::Vector4f at(const Eigen::Vector3d& point_mm, const Eigen::Vector3d& normal,
                                     double sample_spacing_mm) const;
    /// The same by texture coordinates; `spacing`: in them.
    [[nodiscard]] Eigen::Vector4f at_uv(const Eigen::Vector2f& uv, double spacing) const;

private:
    [[nodiscard]] Eigen::Vector4f picture_at(double along, double up_share, double spacing) const;
};

}  // namespace voxtone::io
