// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_sources.h"

#include <algorithm>

namespace voxtone::slicer {

void body_voxels(const LayerSources& sources, int first, int last, int counted_from, SpanSlab& out,
                 LayerCounts& counts) {
    if (sources.thin) {
        const std::uint64_t added = sources.thin->slab(first, last, out);
        if (last > counted_from) counts.thin_voxels += added;
    } else {
        sources.solid.slab(first, last, out);
    }
    for (int k = std::max(first, counted_from); k < last; ++k) counts.body_voxels += out.voxels_of_layer(k);
}

}  // namespace voxtone::slicer
