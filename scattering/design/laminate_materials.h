// SPDX-License-Identifier: GPL-3.0-or-later
//
// Materials for the laminate search: layer profiles of every channel on one grid, from resins or from measured
// profiles.
//
// A material is known at one thickness and predicted at others by Kubelka and Munk's law, which holds for the model,
// not for light (docs/profiles.md): a layer of a fifth of the known thickness reflects 11 to 20 % too little. So resins
// are made known, channel by channel, at a thickness amid those that matter: 1.6 transport mean free paths (0.3 mm of
// VeroWhite in green), at least 0.1 mm and at most half of what a laminate may have.
//
// Units: mm. What it cannot see: as layer_profile.h.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "optics/monte_carlo/layer_paths.h"
#include "optics/numerics/hankel.h"
#include "optics/profiles/measured_profile.h"
#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

/// 1.6 / (sigma_a + (1 - g) sigma_s), within [0.1 mm, most_mm / 2]; most_mm > 0.
[[nodiscard]] double fitting_known_mm(const optics::Medium& medium, double g, double most_mm);

/// known_mm: one thickness for all channels, as many as channels otherwise, all > 0. Contract: a resin of the set.
[[nodiscard]] LaminateMaterial resin_material(const optics::ResinSet& set, std::size_t resin,
                                              std::span<const double> known_mm, const optics::HankelGrid& grid,
                                              const optics::LayerPathOptions& options = {},
                                              const Progress* progress = nullptr);

struct MeasuredMaterial {
    LaminateMaterial material;
    std::vector<optics::MeasuredSummary> summary;  ///< by channel
};

/// Profiles of any spacing and length. Throws InputError that names the material, the channel and what is wrong.
[[nodiscard]] MeasuredMaterial measured_material(const std::string& name,
                                                 std::span<const optics::MeasuredProfile> by_channel,
                                                 const optics::HankelGrid& grid);

}  // namespace voxtone::scattering
