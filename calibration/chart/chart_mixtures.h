// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which mixtures a chart holds, so that few patches tell most: every solid, halves of every two resins, then always the
// mixture that is farthest from all that were taken, among many that fill what can be mixed (mixture_samples.h). Far is
//
//   d^2 = |Delta Lab / 10|^2 + sum_r (Delta ln(f_r + 0.01))^2
//
// Lab by what a set says of them: a chart spreads over what will be seen, and over shares where colours do not change.
// The scale of the two was chosen on measured mixtures of a J750 (docs/decisions/012).
#pragma once

#include <cstddef>
#include <vector>

#include "optics/media/resins.h"

namespace voxtone::calibration {

/// The fewest patches that hold every solid and every half of two resins.
[[nodiscard]] std::size_t least_chart_patches(std::size_t resins);

/// `count` mixtures of the set's resins in whole percent, the same at every call, in the order in which they were
/// taken. Contract: two resins or more, count >= least_chart_patches.
[[nodiscard]] std::vector<std::vector<int>> chart_mixtures(const optics::ResinSet& set, std::size_t count);

}  // namespace voxtone::calibration
