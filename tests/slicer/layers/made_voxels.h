// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers as voxels, for tests that look at each of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "slicer/layers/layer_maker.h"

namespace voxtone::test {

struct MadeVoxels {
    slicer::VoxelGrid grid;
    std::vector<io::Material> materials;  ///< x fastest, then y, then z
    slicer::LayerCounts counts;

    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return (std::size_t(k) * std::size_t(grid.size[1]) + std::size_t(j)) * std::size_t(grid.size[0]) +
               std::size_t(i);
    }
    [[nodiscard]] io::Material at(int i, int j, int k) const { return materials[index(i, j, k)]; }
};

/// Of the layers [k_begin, k_end); the others stay air.
[[nodiscard]] inline MadeVoxels made_voxels(const slicer::LayerSources& sources, int k_begin, int k_end) {
    MadeVoxels made{sources.solid.grid(), {}, {}};
    made.materials.assign(made.grid.voxels(), io::background);
    const slicer::LayerMaker maker(sources);
    for (int slab = 0; slab * maker.slab_layers() < made.grid.size[2]; ++slab)
        made.counts += maker.make(slab, k_begin, k_end, [&](int k, const io::LayerRuns& layer) {
            for (std::uint32_t y = 0; y < layer.height_px(); ++y) {  // rows run along -y
                std::size_t at = made.index(0, made.grid.size[1] - 1 - int(y), k);
                for (const io::Run run : layer.row(y))
                    for (int n = 0; n < run.length; ++n) made.materials[at++] = io::Material(run.material);
            }
        });
    return made;
}

[[nodiscard]] inline MadeVoxels made_voxels(const slicer::LayerSources& sources) {
    return made_voxels(sources, 0, sources.solid.grid().size[2]);
}

/// The same for a part whose corner stands at `at` of a print, in layers [k_begin, k_end). `others`: places at which it
/// stands too.
[[nodiscard]] inline MadeVoxels placed_voxels(const slicer::LayerSources& sources, const std::array<int, 3>& at,
                                              int k_begin, int k_end, int others = 0) {
    std::vector<std::array<int, 3>> places{at};
    for (int n = 1; n <= others; ++n) places.push_back({at[0] + 17 * n, at[1] + 5 * n, at[2]});
    MadeVoxels made{sources.solid.grid(), {}, {}};
    made.materials.assign(made.grid.voxels(), io::background);
    const slicer::LayerMaker maker(sources);
    const int depth = maker.slab_layers();
    for (int slab = k_begin / depth; slab * depth < k_end; ++slab) {
        const auto layers = maker.slab_layers_of(slab, k_begin, k_end, places, made.counts);
        for (int k = std::max(k_begin, slab * depth); k < std::min(k_end, (slab + 1) * depth); ++k)
            for (int j = 0; j < made.grid.size[1]; ++j) {
                io::LayerRuns row(std::uint32_t(made.grid.size[0]), 1);
                layers->push_row(j, k, at, row);
                row.end_row();
                std::size_t next = made.index(0, j, k);
                for (const io::Run run : row.row(0))
                    for (int n = 0; n < run.length; ++n) made.materials[next++] = io::Material(run.material);
            }
    }
    return made;
}

}  // namespace voxtone::test
