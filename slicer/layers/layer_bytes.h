// SPDX-License-Identifier: GPL-3.0-or-later
//
// About how much disk layers take, before they are made: the halftone of the coloured shell is what takes the bytes,
// 0.13 to 0.36 of a byte a voxel and bitmap in bodies and pictures of 15 to 60 mm (`slice --iterations 0`), counted as
// 0.36; a file takes whole blocks of the disk.
#pragma once

#include <cstddef>
#include <cstdint>

#include "io/layers/layer_stack_writer.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

struct LayerBytesQuery {
    double coloured_area_mm2 = 0, shell_mm = 0;
    int layers = 0;  ///< of those of the grid
    io::StackOutputs outputs;
    std::size_t resins = 0;
};

[[nodiscard]] std::uint64_t layer_bytes(const VoxelGrid& grid, const LayerBytesQuery& query);

}  // namespace voxtone::slicer
