// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/resin_laminate.h"

#include <cmath>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

void check(const ResinSet& set, std::span<const ResinLayer> layers, const LaminateEnds& ends) {
    VOXTONE_EXPECT(!layers.empty() && (ends.sheet == 0 || ends.eta_bottom == 1));
    for (const ResinLayer& layer : layers) VOXTONE_EXPECT(layer.resin < set.resins.size() && layer.thickness_mm > 0);
}

// Every channel has random numbers of its own.
LayerPathOptions seeded(LayerPathOptions options, std::size_t channel) {
    options.seed += 1000 * channel;
    return options;
}

}  // namespace

LaminateLight traced_light(const ResinSet& set, std::span<const ResinLayer> layers, const LaminateEnds& ends,
                           const HankelGrid& grid, const LayerPathOptions& options, const Progress* progress) {
    check(set, layers, ends);
    LaminateLight light;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        // What is matched stays so.
        const auto at_end = [&](double eta, const ResinLayer& layer) {
            return eta > 1 ? set.resins[layer.resin].eta.value_or(eta) : 1;
        };
        LayerScene scene{
            {}, set.g, at_end(ends.eta_top, layers.front()), at_end(ends.eta_bottom, layers.back()), ends.sheet};
        for (const ResinLayer& layer : layers) {
            const Resin& resin = set.resins[layer.resin];
            scene.layers.push_back({resin.own_medium(c), layer.thickness_mm, resin.g, set.eta_of(resin)});
        }
        const TracedProfile traced = trace_layers(scene, grid, seeded(options, c), progress);
        RingLight T = traced.T;
        for (std::size_t i = 0; i < T.light.size(); ++i) T.light[i] += traced.T_direct.light[i];
        light.R.push_back(grid.from_rings(traced.edges_mm, traced.R.light));
        light.T.push_back(grid.from_rings(traced.edges_mm, T.light));
        light.R_error.push_back(traced.R.standard_error);
        light.T_error.push_back(std::hypot(traced.T.standard_error, traced.T_direct.standard_error));
    }
    return light;
}

double radius_of_share(const HankelGrid& grid, std::span<const double> coefficients, double share) {
    double inside = 0, outside = grid.reach_mm();
    for (int step = 0; step < 40; ++step) {
        const double r = 0.5 * (inside + outside);
        (grid.light_within(coefficients, r) < share * coefficients[0] ? inside : outside) = r;
    }
    return outside;
}

}  // namespace voxtone::optics
