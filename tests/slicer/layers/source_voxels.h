// SPDX-License-Identifier: GPL-3.0-or-later
//
// The voxels of whatever has layers, for tests that look at each of them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "slicer/layers/layer_source.h"

namespace voxtone::test {

struct SourceVoxels {
    std::array<int, 3> size{};
    std::vector<io::Material> materials;  ///< x fastest, then y, then z

    [[nodiscard]] io::Material at(int i, int j, int k) const {
        return materials[(std::size_t(k) * std::size_t(size[1]) + std::size_t(j)) * std::size_t(size[0]) +
                         std::size_t(i)];
    }
    friend bool operator==(const SourceVoxels&, const SourceVoxels&) = default;
};

[[nodiscard]] inline SourceVoxels source_voxels(const slicer::LayerSource& source) {
    SourceVoxels made{source.grid().size, {}};
    const int width = made.size[0], height = made.size[1], layers = made.size[2];
    made.materials.resize(source.grid().voxels());
    for (int slab = 0; slab * source.slab_layers() < layers; ++slab)
        (void)source.make(slab, 0, layers, [&](int k, const io::LayerRuns& layer) {
            for (int j = 0; j < height; ++j) {  // rows run along -y
                std::size_t at = (std::size_t(k) * std::size_t(height) + std::size_t(j)) * std::size_t(width);
                for (const io::Run run : layer.row(std::uint32_t(height - 1 - j)))
                    for (int n = 0; n < run.length; ++n) made.materials[at++] = io::Material(run.material);
            }
        });
    return made;
}

}  // namespace voxtone::test
