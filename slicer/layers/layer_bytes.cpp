// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_bytes.h"

#include <algorithm>

namespace voxtone::slicer {

std::uint64_t layer_bytes(const VoxelGrid& grid, const LayerBytesQuery& query) {
    constexpr double bytes_per_shell_voxel = 0.36;
    constexpr std::uint64_t block_bytes = 4096;
    const double box_voxels = double(grid.size[0]) * double(grid.size[1]) * double(grid.size[2]);
    const double shell_voxels = std::min(box_voxels, query.coloured_area_mm2 * query.shell_mm / grid.pitch_mm.prod());
    const bool per_resin = query.outputs.resin_bitmaps != io::ResinBitmaps::none;
    // One bitmap of a bit for each resin takes together about what one of all colours does.
    // A volume's numbers do, too, and its grids of floating point take some 2.5 times that.
    const int copies = 1 + int(per_resin) + int(query.outputs.gcvf) + 4 * int(query.outputs.vdb);
    const double part = double(query.layers) / double(grid.size[2]);
    const std::uint64_t files = std::uint64_t(query.layers) * (per_resin ? 1 + query.resins : 1);
    return static_cast<std::uint64_t>(bytes_per_shell_voxel * shell_voxels * part * copies) + files * block_bytes;
}

}  // namespace voxtone::slicer
