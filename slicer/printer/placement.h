// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the numbers of a model file to millimetres on the printer's tray, and from there to the voxel grid.
//
//   p_mm = flips * swap * rotations * (factor * p_file),   then moved so that the smallest coordinate of each axis is 0
//
// with factor = mm per file unit * scale, or whatever makes the largest extent `size_mm`. A map that mirrors (one flip,
// or a swap) also turns the triangles around, so that a body stays right side out.
#pragma once

#include <array>
#include <string>

#include <Eigen/Core>

#include "io/models/mesh.h"
#include "slicer/options/placement_options.h"
#include "slicer/printer/printer.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

struct Placement {
    double mm_per_file_unit = 1;
    bool unit_assumed = false;  ///< the format has no unit and the user gave none
    Eigen::Vector3d extent_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d corner_mm = Eigen::Vector3d::Zero();  ///< where the lowest corner was before it was moved to 0
    bool is_picture = false;
    bool is_scaled = false;  ///< to a size, whatever the unit
    std::string summary;     ///< one line for the user: unit and size
};

/// Moves, scales and turns the mesh in place. `name`: of the model, for messages. Throws InputError where nothing has
/// an extent.
Placement place(io::ModelFile& model, const PlacementOptions& options, const std::string& name);

/// Throws InputError for a model smaller than a voxel or larger than the tray (10 m where it has no end), with the size
/// that would do: before anything is done with such numbers.
void check_extent(const Placement& placement, const Eigen::Vector3d& pitch_mm, const Eigen::Vector3d& tray_mm);

/// Grid of this pitch that is as large as the box to the nearest voxel (voxels_in), centred on it: the box stands out
/// by a quarter of a voxel at most, so that no voxel's centre in it lies outside of the grid.
[[nodiscard]] VoxelGrid grid_around(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm,
                                    const Eigen::Vector3d& pitch_mm);

/// Throws InputError when the grid does not fit the tray, with the size that would.
void check_tray(const VoxelGrid& grid, const Eigen::Vector3d& tray_mm, const Placement& placement);

/// Throws InputError for a print of fewer layers than the printer takes; `remedy` goes on: "make it ...".
void check_layer_count(int layers, const PrinterProfile& printer, const std::string& remedy);

}  // namespace voxtone::slicer
