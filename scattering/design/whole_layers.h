// SPDX-License-Identifier: GPL-3.0-or-later
//
// A laminate as a printer makes it: every border on a whole number of printed layers from the top.
#pragma once

#include <span>
#include <vector>

#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

/// Borders go to the nearest multiple of layer_mm > 0, so no border is off by more than half a printed layer; below
/// that only where a material would come nearer to the top than clear_top_mm allows (by material; empty: no limits).
/// What becomes 0 thick is left out, and like neighbours are joined.
[[nodiscard]] std::vector<LaminateLayer> whole_layers(std::span<const LaminateLayer> layers, double layer_mm,
                                                      std::span<const double> clear_top_mm = {});

/// The same, then single printed layers given to a layer, taken from it, or handed to another, whatever brings the
/// reflection nearest to the target, until nothing does: never further away than whole_layers. Keeps thickness_mm,
/// clear_top_mm; dc_weight and backing count (laminate_search.h). Layers that are there stay, none is added.
[[nodiscard]] std::vector<LaminateLayer> settled_layers(std::span<const LaminateMaterial> materials,
                                                        std::span<const LaminateLayer> layers, double layer_mm,
                                                        const ChannelProfiles& target,
                                                        const LaminateSearchOptions& options);

}  // namespace voxtone::scattering
