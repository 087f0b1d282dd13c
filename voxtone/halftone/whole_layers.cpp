// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/whole_layers.h"

#include <algorithm>
#include <cmath>

#include "voxtone/base/contracts.h"

namespace voxtone::halftone {

std::vector<StackLayer> whole_layers(std::span<const StackLayer> layers, double layer_mm,
                                     std::span<const double> clear_top_mm) {
    VOXTONE_EXPECT(layer_mm > 0);
    constexpr double rounding = 1e-6;  // of a printed layer: a border that is there already stays
    std::vector<StackLayer> whole;
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

}  // namespace voxtone::halftone
