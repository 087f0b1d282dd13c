// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/shortened_laminate.h"

namespace voxtone::scattering {

std::vector<LaminateLayer> shortened_laminate(std::vector<LaminateLayer> layers, double most,
                                              const std::function<double(std::span<const LaminateLayer>)>& distance) {
    if (!(distance(layers) <= most)) return layers;
    while (!layers.empty() && distance(std::span(layers).first(layers.size() - 1)) <= most) layers.pop_back();
    if (layers.empty()) return layers;
    double& lowest = layers.back().thickness_mm;
    double too_thin = 0, good = lowest;
    constexpr int halvings = 10;
    for (int step = 0; step < halvings; ++step) {
        lowest = 0.5 * (too_thin + good);
        (distance(layers) <= most ? good : too_thin) = lowest;
    }
    lowest = good;
    return layers;
}

}  // namespace voxtone::scattering
