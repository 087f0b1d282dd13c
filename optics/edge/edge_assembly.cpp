// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/edge/edge_assembly.h"

#include <cmath>
#include <numbers>

#include "base/contracts.h"

namespace voxtone::optics {

std::vector<EdgeLayer> edge_layers(const EdgeAssembly& assembly, double slab_mm) {
    std::vector<EdgeLayer> layers;
    if (assembly.glass) layers.push_back({assembly.glass_index, assembly.glass_mm, false, 0});
    if (assembly.gel) layers.push_back({assembly.gel_index, assembly.gel_above_mm, false, 0});
    layers.push_back({assembly.slab_index, slab_mm, true, assembly.slab_roughness});
    if (assembly.gel) layers.push_back({assembly.gel_index, assembly.gel_below_mm, false, assembly.slab_roughness});
    if (assembly.sheet_surface) layers.push_back({assembly.sheet_index, 0, false, assembly.sheet_roughness});
    return layers;
}

DirectionWindow light_window(const EdgeAssembly& assembly) {
    const auto cosine = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
    const double from = assembly.light_deg - assembly.light_half_width_deg,
                 to = assembly.light_deg + assembly.light_half_width_deg;
    VOXTONE_EXPECT(from >= 0 && to <= 90 && to > from);
    return {cosine(to), cosine(from)};
}

}  // namespace voxtone::optics
