// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/edge/edge_stack.h"

#include <cmath>
#include <numbers>

#include "base/contracts.h"

namespace voxtone::optics {

std::vector<EdgeLayer> edge_layers(const EdgeStack& stack, double slab_mm) {
    std::vector<EdgeLayer> layers;
    if (stack.glass) layers.push_back({stack.glass_index, stack.glass_mm, false, 0});
    if (stack.gel) layers.push_back({stack.gel_index, stack.gel_above_mm, false, 0});
    layers.push_back({stack.slab_index, slab_mm, true, stack.slab_roughness});
    if (stack.gel) layers.push_back({stack.gel_index, stack.gel_below_mm, false, stack.slab_roughness});
    if (stack.sheet_surface) layers.push_back({stack.sheet_index, 0, false, stack.sheet_roughness});
    return layers;
}

DirectionWindow light_window(const EdgeStack& stack) {
    const auto cosine = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
    const double from = stack.light_deg - stack.light_half_width_deg, to = stack.light_deg + stack.light_half_width_deg;
    VOXTONE_EXPECT(from >= 0 && to <= 90 && to > from);
    return {cosine(to), cosine(from)};
}

}  // namespace voxtone::optics
