// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a change of the resins is felt.
//
// Predicted, not estimated: on a slab of core resin, 3.2 mm thick over a black sheet, a line of the surface one viewing
// cell wide and deep is changed from the core's resin to another, all across; the figure is the distance from the line
// beyond which no channel of the appearance changes by more than the tolerance. One cell of the line alone is felt less
// far. The slab is 24 mm long: nothing farther than that is looked for.
//
// No part of a job asks for it: it is for whoever has to choose how far to look (halos, the reach of a change) for
// other resins, and a test that the predictor carries light as far as it should.
#pragma once

#include <array>

#include "voxtone/optics/media/resins.h"

namespace voxtone::optics {

/// In mm; 0 where even the line itself changes by less. `core` and `changed` are indices into the set; tolerance > 0 in
/// units of appearance. Time: a tenth of a second or so.
[[nodiscard]] double interaction_radius(const ResinSet& resins, const std::array<double, 3>& pitch_mm, std::size_t core,
                                        std::size_t changed, double tolerance);

/// The largest over all resins of the set on this core.
[[nodiscard]] double interaction_radius(const ResinSet& resins, const std::array<double, 3>& pitch_mm, std::size_t core,
                                        double tolerance);

}  // namespace voxtone::optics
