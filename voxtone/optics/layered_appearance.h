// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a stack of plane-parallel layers under a smooth surface looks like, by the modes of its layers (layer_modes.h).
//
// Two geometries, never to be mixed:
//   appearance    uniform diffuse light in, all light out: flux that leaves through the surface / flux that entered it,
//   the
//                 first reflection left out; exactly 1 for a stack that absorbs nothing.
//   rho(45 -> 0)  light from 45 degrees, seen from the normal: pi L_o / E, mirror reflection left out; a perfect
//   diffuser has 1
//                 (Iser, Rittig, Wilkie 2025, Sec. 3.1). Azimuth does not matter because the view is the normal.
// Units: mm and mm^-1. All layers share g and eta; a layer that neither scatters nor absorbs (clear resin) is not seen.
// Error with `appearance_plan`: below 1e-5 in appearance; with `directional_plan`: 4e-6 in rho, for g = 0.4, eta = 1.5
// (tested).
#pragma once

#include <span>

#include "voxtone/optics/layer_modes.h"

namespace voxtone::optics {

struct LayerOf {
    Medium medium;
    double thickness_mm = 0;
};

/// A plan for appearance: 5 trapped and 5 escaping directions suffice for resins.
[[nodiscard]] OrdinatePlan appearance_plan(double g, double eta, int below = 5, int above = 5);

/// A plan for rho(45 -> 0): 15 directions, 45 and 0 degrees among them.
[[nodiscard]] OrdinatePlan directional_plan(double g, double eta);

/// The law of a homogeneous half-space.
[[nodiscard]] Admittance half_space(const OrdinatePlan& plan, const Medium& medium);

/// The law at the top of layers (top first) over a base.
[[nodiscard]] Admittance stack(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first,
                               const Admittance& base);

/// Appearance of what has this law just under its surface.
[[nodiscard]] double appearance(const OrdinatePlan& plan, const Admittance& top);

/// rho for light from cosine mu_in and a view along cosine mu_out in air, averaged over azimuth. Both must be nodes of
/// the grid, and different ones. Symmetric.
[[nodiscard]] double reflectance_factor(const OrdinatePlan& plan, const Admittance& top, double mu_in, double mu_out);

[[nodiscard]] double layered_appearance(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first,
                                        const Admittance& base);
[[nodiscard]] double reflectance_45_0(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first,
                                      const Admittance& base);

}  // namespace voxtone::optics
