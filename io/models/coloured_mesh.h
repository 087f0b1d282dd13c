// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh with one colour per vertex, as the preview files hold it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

struct ColouredMesh {
    std::vector<Eigen::Vector3f> positions_mm;  ///< z up
    std::vector<Eigen::Vector3f> rgb;           ///< linear sRGB in [0, 1], one per position
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace voxtone::io
