// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stacking as a printer makes it: every border on a whole number of printed layers from the top.
#pragma once

#include <span>
#include <vector>

#include "voxtone/halftone/stack_search.h"

namespace voxtone::halftone {

/// Borders go to the nearest multiple of layer_mm > 0, so no border is off by more than half a printed layer; below
/// that only where a material would come nearer to the top than clear_top_mm allows (by material; empty: no limits).
/// What becomes 0 thick is left out, and like neighbours are joined.
[[nodiscard]] std::vector<StackLayer> whole_layers(std::span<const StackLayer> layers, double layer_mm,
                                                   std::span<const double> clear_top_mm = {});

}  // namespace voxtone::halftone
