// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Geometry>

namespace voxtone::slicer {

/// The box around the corners that triangles use; empty without any.
[[nodiscard]] inline Eigen::AlignedBox3d bounding_box(std::span<const Eigen::Vector3d> positions,
                                                      std::span<const std::array<std::uint32_t, 3>> triangles) {
    Eigen::AlignedBox3d box;
    for (const auto& triangle : triangles)
        for (const std::uint32_t corner : triangle) box.extend(positions[corner]);
    return box;
}

}  // namespace voxtone::slicer
