// SPDX-License-Identifier: GPL-3.0-or-later
//
// Raised and engraved marks as voxels: where there is ink, so many voxels outside of the surface are added, or so many
// inside taken away, straight along the mark's direction. A voxel has ink where more than half of the ink's pixel at
// its middle is covered.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "io/lettering/coverage.h"
#include "io/models/decal.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/solid/relief.h"
#include "slicer/surface/mark_frame.h"

namespace voxtone::slicer {

struct EmbossedMark {
    MarkFrame frame;
    io::DepthMap surface;  ///< below the frame
    io::Coverage ink;
    int voxels = 0;  ///< above 0 raised, below engraved
};

/// Of a voxel along a direction.
[[nodiscard]] double voxel_mm_along(const Eigen::Vector3d& pitch_mm, const Eigen::Vector3d& direction);

/// The box that the raised ones reach into; empty where none is raised.
[[nodiscard]] Eigen::AlignedBox3d box_of_raised(std::span<const EmbossedMark> marks, const Eigen::Vector3d& pitch_mm);

/// `shell_mm`: how deep below them depths are counted from the relief.
[[nodiscard]] Relief relief_of(std::span<const EmbossedMark> marks, const VoxelGrid& grid, double shell_mm);

}  // namespace voxtone::slicer
