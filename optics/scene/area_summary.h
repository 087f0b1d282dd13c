// SPDX-License-Identifier: GPL-3.0-or-later
//
// Differences over a surface in a few figures: each cell weighs with its area, as a viewer sees it.
#pragma once

#include <span>

#include "optics/colour/colour.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

/// One difference per cell. `counts`: one per cell, 0 leaves it out; empty: all count. Percentiles: the smallest
/// difference that this share of the area does not exceed. All zero where nothing counts.
[[nodiscard]] DifferenceSummary summarize_by_area(const Surface& cells, std::span<const double> differences,
                                                  std::span<const char> counts = {});

}  // namespace voxtone::optics
