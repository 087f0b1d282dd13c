// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a stack of plane-parallel layers under a smooth surface looks like, by the modes of its layers (layer_modes.h).
//
// Two geometries, never to be mixed:
//   appearance    uniform diffuse light in, all light out: flux that leaves through the surface / flux that entered it;
//                 the first reflection left out; exactly 1 for a stack that absorbs nothing.
//   rho(45 -> 0)  light from 45 degrees, seen from the normal: pi L_o / E, mirror reflection left out; a perfect
//                 diffuser has 1 (Iser, Rittig, Wilkie 2025, Sec. 3.1); azimuth does not matter for this view.
//
// Units: mm and mm^-1. All layers share g and eta; a layer that neither scatters nor absorbs (clear resin) is not seen.
// Error with the default plans, g = 0.4, eta = 1.5 (tested): appearance 3e-5, worst for dark films thinner than a free
// path; rho 1e-6 for calibration patches, 2e-5 for stacks of films of 27 um. 10 + 10 directions: 2e-6 for all.
#pragma once

#include <span>

#include "optics/layered/layer_modes.h"

namespace voxtone::optics {

struct LayerOf {
    Medium medium;
    double thickness_mm = 0;
};

/// A plan for appearance: this many trapped and escaping directions.
[[nodiscard]] OrdinatePlan appearance_plan(double g, double eta, int below = 6, int above = 6);

/// A plan for rho(45 -> 0): the same and two for 45 and 0 degrees, 15 in all.
[[nodiscard]] OrdinatePlan directional_plan(double g, double eta, int below = 7, int above = 6);

/// The law of a homogeneous half-space.
[[nodiscard]] Admittance half_space(const OrdinatePlan& plan, const Medium& medium);

/// The law at the top of layers (top first) over a base.
[[nodiscard]] Admittance layered_admittance(const OrdinatePlan& plan, std::span<const LayerOf> layers_top_first,
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
