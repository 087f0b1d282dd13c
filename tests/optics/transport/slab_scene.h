// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slabs that go on for ever: the same problem as voxels with mirrored sides and as plane-parallel layers, whose
// solution is exact.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "optics/layered/layered_appearance.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics::testing {

/// A set with the resins of `of` and these mixtures of them (Eq. 7) as resins of their own.
inline ResinSet with_mixtures(const ResinSet& of, const std::vector<std::vector<double>>& mixtures) {
    ResinSet set = of;
    for (const auto& fractions : mixtures) {
        Resin resin;
        resin.role = std::string(1, static_cast<char>('a' + set.resins.size()));
        resin.name = resin.role;
        for (std::size_t c = 0; c < of.channels.size(); ++c) {
            const Medium medium = of.mix(fractions, c);
            resin.sigma_t_per_mm.push_back(medium.sigma_t());
            resin.albedo.push_back(medium.albedo());
        }
        set.resins.push_back(resin);
    }
    return set;
}

/// Layers of whole voxels, the uppermost first.
struct SlabLayer {
    Material material = 0;
    int voxels = 1;
};

inline constexpr std::array<double, 3> slab_pitch_mm{0.0423333, 0.0846667, 0.027};

inline ResinVolume slab_volume(std::span<const SlabLayer> top_first, int width = 3, int depth = 2) {
    std::vector<Material> column;
    for (const SlabLayer& layer : top_first)
        column.insert(column.end(), static_cast<std::size_t>(layer.voxels), layer.material);
    std::reverse(column.begin(), column.end());
    return make_resin_volume({width, depth, static_cast<int>(column.size())}, slab_pitch_mm,
                             [&](int, int, int z) { return column[static_cast<std::size_t>(z)]; });
}

/// Exact to 2e-6 (layered_appearance.h).
inline double exact_appearance(const ResinSet& set, std::span<const SlabLayer> top_first, Backing backing,
                               std::size_t channel) {
    const OrdinatePlan plan = appearance_plan(set.g, set.eta, 10, 10);
    std::vector<LayerOf> layers;
    for (const SlabLayer& layer : top_first)
        layers.push_back({set.resins[layer.material - 1u].medium(channel), layer.voxels * slab_pitch_mm[2]});
    return layered_appearance(
        plan, layers,
        backing == Backing::white ? Admittance::white_sheet(plan) : Admittance::air(plan, backing == Backing::none));
}

/// rho(45 -> 0), exact to 2e-5 for thin films, 1e-6 for thick layers (layered_appearance.h).
inline double exact_45_0(const ResinSet& set, std::span<const SlabLayer> top_first, Backing backing,
                         std::size_t channel) {
    const OrdinatePlan plan = directional_plan(set.g, set.eta, 10, 10);
    std::vector<LayerOf> layers;
    for (const SlabLayer& layer : top_first)
        layers.push_back({set.resins[layer.material - 1u].medium(channel), layer.voxels * slab_pitch_mm[2]});
    // Nothing shines from below: `none` is as black as the black sheet.
    return reflectance_45_0(plan, layers,
                            backing == Backing::white ? Admittance::white_sheet(plan) : Admittance::air(plan, false));
}

/// The appearance of all channels of a slab with mirrored sides by some model.
inline Appearance slab_appearance(const AppearanceModel& model, const ResinSet& set,
                                  std::span<const SlabLayer> top_first, Backing backing) {
    const ResinVolume volume = slab_volume(top_first);
    const Scene scene{&volume, &set, backing, Sides::mirrored};
    return model.predict(scene, find_surface(scene, {volume.size()[0], volume.size()[1], 1}, SurfacePart::top));
}

}  // namespace voxtone::optics::testing
