// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/resin_laminate.h"

#include <cmath>

#include "base/contracts.h"
#include "optics/profiles/resin_profile.h"
#include "optics/profiles/saunderson.h"

namespace voxtone::optics {
namespace {

void check(const ResinSet& set, std::span<const ResinLayer> layers, const LaminateEnds& ends) {
    VOXTONE_EXPECT(!layers.empty() && (ends.sheet == 0 || ends.eta_bottom == 1));
    for (const ResinLayer& layer : layers) VOXTONE_EXPECT(layer.resin < set.resins.size() && layer.thickness_mm > 0);
}

// Every layer has random numbers of its own, and so has every channel.
LayerPathOptions seeded(LayerPathOptions options, std::size_t channel, std::size_t layer) {
    options.seed += 1000 * channel + 2 * layer;
    return options;
}

LayerProfile between_ends(const ResinSet& set, std::span<const ResinLayer> layers, std::size_t channel,
                          const LaminateEnds& ends, const HankelGrid& grid, const LayerPathOptions& options,
                          const Progress* progress) {
    LayerProfile all = no_layer(grid.size());
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Medium medium = set.resins[layers[i].resin].medium(channel);
        const double mm = layers[i].thickness_mm;
        const LayerPathOptions own = seeded(options, channel, i);
        const bool first = i == 0, last = i + 1 == layers.size();
        if (first && ends.eta_top > 1)
            all = bounded_layer(medium, set.g, ends.eta_top, mm, grid, own, progress);
        else if (last && ends.eta_bottom > 1)
            all = laminate(all, turned_over(bounded_layer(medium, set.g, ends.eta_bottom, mm, grid, own, progress)));
        else
            all = laminate(all, resin_profile(medium, set.g, mm, grid, own, progress).layer().of_thickness(mm));
    }
    // A single layer cannot be made together with both of its surfaces.
    if (layers.size() == 1 && ends.eta_top > 1 && ends.eta_bottom > 1)
        all = laminate(all, turned_over(smooth_surface(ends.eta_bottom, grid.size())));
    return all;
}

}  // namespace

LaminateLight layered_light(const ResinSet& set, std::span<const ResinLayer> layers, const LaminateEnds& ends,
                            const HankelGrid& grid, const LayerPathOptions& options, const Progress* progress) {
    check(set, layers, ends);
    // T of a bounded layer is the root of the way in times the way out; they differ by the factor 1 - s.
    const double way_in = std::sqrt((1 - internal_diffuse_reflectance(ends.eta_bottom)) /
                                    (1 - internal_diffuse_reflectance(ends.eta_top)));
    LaminateLight light;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const LayerProfile all = between_ends(set, layers, c, ends, grid, options, progress);
        std::vector<double>&R = light.R.emplace_back(all.R_top), &T = light.T.emplace_back(all.T);
        for (std::size_t i = 0; i < grid.size(); ++i) {
            const double down = all.T[i] / (1 - all.R_bottom[i] * ends.sheet);
            R[i] += all.T[i] * ends.sheet * down;
            T[i] = way_in * down * (1 - ends.sheet);
        }
    }
    light.R_error.assign(light.R.size(), 0.0);
    light.T_error = light.R_error;
    return light;
}

LaminateLight traced_light(const ResinSet& set, std::span<const ResinLayer> layers, const LaminateEnds& ends,
                           const HankelGrid& grid, const LayerPathOptions& options, const Progress* progress) {
    check(set, layers, ends);
    LaminateLight light;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        LayerScene scene{{}, set.g, ends.eta_top, ends.eta_bottom, ends.sheet};
        for (const ResinLayer& layer : layers)
            scene.layers.push_back({set.resins[layer.resin].medium(c), layer.thickness_mm});
        const TracedProfile traced = trace_layers(scene, grid, seeded(options, c, 0), progress);
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
