// SPDX-License-Identifier: GPL-3.0-or-later
//
// A surface with a colour at every point, for pictures and previews: the target or what is predicted.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include <Eigen/Core>

namespace voxtone::slicer {

struct ColouredSurface {
    std::span<const Eigen::Vector3d> positions_mm;
    std::span<const std::array<std::uint32_t, 3>> triangles;
    /// Linear sRGB of the point corner0 + u (corner1 - corner0) + v (corner2 - corner0); called from any thread.
    std::function<Eigen::Vector3f(std::uint32_t triangle, float u, float v)> colour;
};

}  // namespace voxtone::slicer
