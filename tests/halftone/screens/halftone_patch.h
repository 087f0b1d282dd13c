// SPDX-License-Identifier: GPL-3.0-or-later
//
// Flat halftones as the printer makes them, and what Monte Carlo sees of them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "halftone/screens/blue_noise_screen.h"
#include "halftone/screens/error_diffusion.h"
#include "halftone/separation/mixture.h"
#include "optics/layered/shell_appearance.h"
#include "optics/monte_carlo/monte_carlo.h"

namespace voxtone {

/// A slab of the screen's whole tile, 64 x 64 columns with mirrors around: `layers` of halftone over `core_layers` of
/// the last resin, on a black sheet.
struct HalftonePatch {
    optics::ResinVolume volume;
    std::vector<double> fractions;  ///< that the screen made of the mixture
};

/// `up`: which axis of the screen and of `pitch_mm` the light comes along, 2 for a picture on a slab.
inline HalftonePatch make_patch(const halftone::BlueNoiseScreen& screen, const std::array<double, 3>& pitch_mm,
                                const halftone::CumulativeMixture& mixture, int resins, int core_resin, int layers,
                                int core_layers, std::size_t up = 2) {
    constexpr int edge = halftone::BlueNoiseScreen::size;
    HalftonePatch patch;
    patch.fractions.assign(static_cast<std::size_t>(resins), 0.0);
    const std::size_t right = (up + 1) % 3, away = (up + 2) % 3;
    const std::array<double, 3> turned{pitch_mm[right], pitch_mm[away], pitch_mm[up]};
    patch.volume = optics::make_resin_volume({edge, edge, layers + core_layers}, turned, [&](int x, int y, int z) {
        if (z < core_layers) return core_resin + 1;
        std::array<int, 3> at{};
        at[right] = x, at[away] = y, at[up] = z;
        const int resin = halftone::select_resin(mixture, screen.threshold(at[0], at[1], at[2]), resins);
        patch.fractions[static_cast<std::size_t>(resin)] += 1.0 / (edge * edge * layers);
        return resin + 1;
    });
    return patch;
}

/// The same by error diffusion, in a rectangle of twice the screen's tile, of which the middle is taken.
inline HalftonePatch make_diffused_patch(const std::array<double, 3>& pitch_mm,
                                         const halftone::CumulativeMixture& mixture, int resins, int core_resin,
                                         int layers, int core_layers) {
    constexpr int edge = halftone::BlueNoiseScreen::size, wide = 2 * edge, margin = edge / 2;
    halftone::ErrorDiffusionOptions options;
    options.pitch_mm = pitch_mm;
    halftone::ErrorDiffusion diffusion(wide, wide, resins, options);
    const std::vector<halftone::CumulativeMixture> mixtures(wide * wide, mixture);
    const std::vector<std::uint8_t> body(wide * wide, 1);
    std::vector<std::uint8_t> layer(wide * wide);
    HalftonePatch patch;
    patch.fractions.assign(static_cast<std::size_t>(resins), 0.0);
    optics::ResinVolumeBuilder builder({edge, edge, layers + core_layers}, pitch_mm);
    std::vector<optics::Material> out(edge * edge, static_cast<optics::Material>(core_resin + 1));
    for (int z = 0; z < core_layers; ++z) builder.add_layer(out);
    for (int z = 0; z < layers; ++z) {
        diffusion.layer(z, mixtures, body, layer);
        for (int y = 0; y < edge; ++y)
            for (int x = 0; x < edge; ++x) {
                const std::uint8_t resin = layer[static_cast<std::size_t>((y + margin) * wide + x + margin)];
                out[static_cast<std::size_t>(y * edge + x)] = static_cast<optics::Material>(resin + 1);
                patch.fractions[resin] += 1.0 / (edge * edge * layers);
            }
        builder.add_layer(out);
    }
    patch.volume = builder.finish();
    return patch;
}

inline halftone::CumulativeMixture cumulative(const std::vector<double>& fractions) {
    halftone::CumulativeMixture mixture;
    mixture.bound.fill(65535);
    double sum = 0;
    for (std::size_t r = 0; r + 1 < fractions.size(); ++r) {
        sum += fractions[r];
        mixture.bound[r] = static_cast<std::uint16_t>(std::fmin(65535.0, std::round(65536 * sum)));
    }
    return mixture;
}

struct Seen {
    std::vector<double> value, standard_error;  ///< per channel
};

/// Mean appearance of the patch.
inline Seen look(const HalftonePatch& patch, const optics::ResinSet& set, std::uint32_t paths, std::uint64_t seed,
                 std::uint32_t first_path = 0) {
    const optics::Scene scene{&patch.volume, &set, optics::Backing::black, optics::Sides::mirrored};
    const std::array<int, 3>& size = patch.volume.size();
    const optics::Surface surface = optics::find_surface(scene, {size[0], size[1], 1}, optics::SurfacePart::top);
    optics::MonteCarloOptions options;
    options.paths = paths;
    options.seed = seed;
    options.first_path = first_path;
    const optics::Appearance seen = optics::MonteCarlo(options).predict(scene, surface);
    return {{seen.value.begin(), seen.value.end()}, {seen.standard_error.begin(), seen.standard_error.end()}};
}

/// The slab's geometry for the separation's forward model; with `voxels` its halftone, else Eq. 7.
inline optics::ShellGeometry geometry_of(const std::array<double, 3>& pitch_mm, int core_resin, int layers,
                                         int core_layers, bool voxels) {
    optics::ShellGeometry geometry;
    geometry.shell_mm = layers * pitch_mm[2];
    geometry.core_resin = core_resin;
    geometry.core_mm = core_layers * pitch_mm[2];
    geometry.backing = optics::Backing::black;
    if (voxels) geometry.pitch_mm = pitch_mm;
    return geometry;
}

}  // namespace voxtone
