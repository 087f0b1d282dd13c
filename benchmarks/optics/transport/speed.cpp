// SPDX-License-Identifier: GPL-3.0-or-later
#include "speed.h"

#include <cmath>
#include <ctime>

#include "halftone_skin.h"

namespace voxtone::accuracy {

using namespace optics;

Cost price_of_slab(const TransportOptions& options, double optical_cells) {
    static const HalftoneSkin skin(suite_resins(), {"C", "M", "Y", "K", "W"}, skin_layers * j750_mm[2],
                                   (slab_layers - skin_layers) * j750_mm[2]);
    // A field of 16 x 16 colours, softly changing.
    std::vector<halftone::CumulativeMixture> field;
    for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i) field.push_back(skin.of_code(40 + 13 * i, 40 + 13 * j, 240 - 6 * (i + j)));
    // About 34 cells of transport per column of voxels where the skin has cells of one voxel.
    const int ny = std::max(8, static_cast<int>(std::lround(std::sqrt(optical_cells / 34 / 2)))), nx = 2 * ny;
    const ResinSet set = suite_resins();
    const ResinVolume volume = make_resin_volume({nx, ny, slab_layers}, j750_mm, [&](int x, int y, int z) {
        return z >= slab_layers - skin_layers
                   ? skin.at(field[static_cast<std::size_t>(y * 16 / ny * 16 + x * 16 / nx)], x, y, z)
                   : resin::W;
    });
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
    Cost cost;
    const std::clock_t begin = std::clock();
    const Appearance seen = TransportPredictor(options).predict(scene, surface, cost.summary);
    cost.core_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    cost.area_mm2 = nx * j750_mm[0] * ny * j750_mm[1];
    cost.voxels = static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * slab_layers;
    cost.optical_cells = cost.summary.cells;
    cost.bytes_per_cell = static_cast<double>(cost.summary.memory_bytes) / static_cast<double>(cost.optical_cells);
    return cost;
}

}  // namespace voxtone::accuracy
