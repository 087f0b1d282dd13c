// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wanted reflections of one albedo and rising width, between two that are given: the targets of Hasan et al. 2010,
// Sec. 8.2.
#pragma once

#include <cstddef>
#include <vector>

#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

/// `count` (>= 1) reflections in even steps from `narrow` to `wide`, mixed linearly after both were scaled to the same
/// total in each channel: the lesser of the two, so that energy is kept. One alone is `narrow`. Contract: the same
/// channels and coefficients, totals above 0.
[[nodiscard]] std::vector<ChannelProfiles> widening_targets(const ChannelProfiles& narrow, const ChannelProfiles& wide,
                                                            std::size_t count);

}  // namespace voxtone::scattering
