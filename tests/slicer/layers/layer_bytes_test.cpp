// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_bytes.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

TEST_CASE("Layers take disk by the voxels of their shell, by how often they are written, and by whole blocks") {
    VoxelGrid grid;
    grid.pitch_mm = {0.05, 0.1, 0.02};
    grid.size = {1000, 500, 200};
    LayerBytesQuery query;
    query.coloured_area_mm2 = 100, query.shell_mm = 0.5;
    query.layers = 200;
    query.outputs = {io::ResinBitmaps::none, false, false};
    query.resins = 5;
    // 50 mm^3 of 0.0001 mm^3 a voxel, 0.36 of a byte each.
    const double once = 0.36 * 500'000;
    constexpr double block = 4096;
    CHECK(double(layer_bytes(grid, query)) == Approx(once + 200 * block).margin(1));
    query.outputs = {io::ResinBitmaps::png1, false, false};  // a file for each resin too, which hold it once more
    CHECK(double(layer_bytes(grid, query)) == Approx(2 * once + 200 * 6 * block).margin(1));
    query.outputs = {io::ResinBitmaps::png1, true, true};
    CHECK(double(layer_bytes(grid, query)) == Approx(7 * once + 200 * 6 * block).margin(1));
    query.outputs = {io::ResinBitmaps::none, true, false};
    CHECK(double(layer_bytes(grid, query)) == Approx(2 * once + 200 * block).margin(1));
    query.layers = 50;  // a quarter of them
    CHECK(double(layer_bytes(grid, query)) == Approx(2 * once / 4 + 50 * block).margin(1));
    // No more voxels than there are.
    query.layers = 200, query.outputs = {io::ResinBitmaps::none, false, false}, query.shell_mm = 1e6;
    CHECK(double(layer_bytes(grid, query)) == Approx(0.36 * 1e8 + 200 * block).margin(1));
}
