// SPDX-License-Identifier: GPL-3.0-or-later
//
// The printer's voxel grid: voxel (i, j, k) is the box origin + pitch * ([i, i+1] x [j, j+1] x [k, k+1]), in mm; i
// along +x (columns of a bitmap), j along +y (rows of a bitmap run the other way), k along +z (layer 0 is the bottom).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace voxtone::slicer {

/// Voxels of a length in mm: the nearest count, at least one. A print is then longer or shorter than its model by half
/// a voxel at most, in the mean neither; counts that hold all of a model make every print longer. Just between two
/// counts it is the lower, with a millionth of slack, so that a length's own rounding is of no account.
[[nodiscard]] inline int voxels_in(double mm, double pitch_mm) {
    return std::max(1, static_cast<int>(std::ceil(mm / pitch_mm - 0.5 - 1e-6)));
}

struct VoxelGrid {
    Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d pitch_mm = Eigen::Vector3d::Ones();
    std::array<int, 3> size{};  ///< voxels along x, y, z

    [[nodiscard]] Eigen::Vector3d centre(int i, int j, int k) const {
        return origin_mm + pitch_mm.cwiseProduct(Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5));
    }
    [[nodiscard]] std::uint64_t voxels() const {
        return std::uint64_t(size[0]) * std::uint64_t(size[1]) * std::uint64_t(size[2]);
    }
    [[nodiscard]] double voxel_volume_mm3() const { return pitch_mm.prod(); }
};

}  // namespace voxtone::slicer
