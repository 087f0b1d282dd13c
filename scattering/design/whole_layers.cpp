// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/whole_layers.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "scattering/design/laminate_search.h"

namespace voxtone::scattering {

std::vector<LaminateLayer> whole_layers(std::span<const LaminateLayer> layers, double layer_mm,
                                        std::span<const double> clear_top_mm) {
    VOXTONE_EXPECT(layer_mm > 0);
    constexpr double rounding = 1e-6;  // of a printed layer: a border that is there already stays
    std::vector<LaminateLayer> whole;
    double wanted_mm = 0, border = 0;  // of the layer's lower side; in printed layers
    for (std::size_t i = 0; i < layers.size(); ++i) {
        wanted_mm += layers[i].thickness_mm;
        double lower = std::round(wanted_mm / layer_mm);
        if (i + 1 < layers.size() && !clear_top_mm.empty())
            lower = std::max(lower, std::ceil(clear_top_mm[layers[i + 1].material] / layer_mm - rounding));
        const double printed = std::max(0.0, lower - border);
        border = std::max(border, lower);
        if (printed == 0) continue;
        if (!whole.empty() && whole.back().material == layers[i].material)
            whole.back().thickness_mm += printed * layer_mm;
        else
            whole.push_back({layers[i].material, printed * layer_mm});
    }
    return whole;
}

std::vector<LaminateLayer> settled_layers(std::span<const LaminateMaterial> materials,
                                          std::span<const LaminateLayer> layers, double layer_mm,
                                          const ChannelProfiles& target, const LaminateSearchOptions& options) {
    constexpr double rounding = 1e-6;
    std::vector<LaminateLayer> best = whole_layers(layers, layer_mm, options.clear_top_mm);
    const auto allowed = [&](const std::vector<LaminateLayer>& tried) {
        double mm = 0;
        for (const auto& [material, thickness_mm] : tried) {
            if (thickness_mm < 0.5 * layer_mm) return false;
            if (!options.clear_top_mm.empty() && mm < options.clear_top_mm[material] - rounding) return false;
            mm += thickness_mm;
        }
        return mm <= options.thickness_mm + rounding;
    };
    const auto distance = [&](const std::vector<LaminateLayer>& tried) {
        return profile_distance(laminate_reflection(materials, tried, options.backing), target, options.weights());
    };
    double least = distance(best);
    for (bool nearer = true; nearer;) {
        nearer = false;
        const std::vector<LaminateLayer> from = best;
        // One printed layer to `i`; from `j`, or from outside.
        for (std::size_t i = 0; i < from.size(); ++i)
            for (std::size_t j = 0; j <= from.size(); ++j)
                for (const double sign : {1.0, -1.0}) {
                    if (i == j || (j < from.size() && sign < 0)) continue;
                    std::vector<LaminateLayer> tried = from;
                    tried[i].thickness_mm += sign * layer_mm;
                    if (j < from.size()) tried[j].thickness_mm -= layer_mm;
                    if (!allowed(tried)) continue;
                    const double d = distance(tried);
                    if (d < least - 1e-12) least = d, best = std::move(tried), nearer = true;
                }
    }
    return best;
}

}  // namespace voxtone::scattering
