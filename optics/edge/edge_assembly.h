// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies on the printed step edge, and what lights it: the virtual setup of Elek et al. 2017, supplement, Sec. 4.3.
//
// From above: air, a glass slip, gel, the slab of resin, gel, the sheet. Layers are plane and endless; the sheet is a
// diffuse base under a surface of its own, printed with a step edge along y at x = 0. Light comes from a ring round the
// vertical, between two angles; the camera looks straight down from far away. What is switched off is not there: its
// neighbours touch.
//
// Units mm, degrees. Indices from 1 to 3. Roughness: alpha of GGX (rough_interface.h).
#pragma once

#include <string>
#include <vector>

namespace voxtone::optics {

struct EdgeAssembly {
    double slab_index = 1.5, slab_roughness = 0.05;
    bool gel = true;
    double gel_index = 1.33, gel_above_mm = 0.03, gel_below_mm = 0.03;
    bool glass = true;
    double glass_index = 1.52, glass_mm = 0.17;
    bool sheet_surface = true;  ///< the sheet's base lies under a dielectric surface
    double sheet_index = 1.5, sheet_roughness = 0.15;
    double light_deg = 45, light_half_width_deg = 10;

    friend bool operator==(const EdgeAssembly&, const EdgeAssembly&) = default;
};

/// A plane layer between interfaces.
struct EdgeLayer {
    double index = 1, thickness_mm = 0;
    bool slab = false;           ///< of resin: it scatters
    double roughness_above = 0;  ///< of its upper side
};

/// The layers with a slab of this thickness, from above; the last lies on the sheet's base.
[[nodiscard]] std::vector<EdgeLayer> edge_layers(const EdgeAssembly& assembly, double slab_mm);

/// Cosines in air between which rays belong to the light or to the camera; equal ends: one direction.
struct DirectionWindow {
    double least = 1, most = 1;
    /// Flux through it of uniform light, part of that from the whole hemisphere.
    [[nodiscard]] double share() const { return most * most - least * least; }
};
[[nodiscard]] DirectionWindow light_window(const EdgeAssembly& assembly);

}  // namespace voxtone::optics
