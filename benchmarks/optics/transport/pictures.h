// SPDX-License-Identifier: GPL-3.0-or-later
//
// Monte Carlo and the predictor side by side, as PNG.
#pragma once

#include <filesystem>

#include "compare.h"

namespace voxtone::accuracy {

/// Reference | prediction | their difference (black 0, white CIEDE2000 5 and more), enlarged; in front of them the
/// target where there is one: the photograph at the cells' resolution. Flat slabs are seen from above, bodies from the
/// front (-y).
void write_side_by_side(const std::filesystem::path& file, const Reference& reference, const Comparison& comparison,
                        const std::vector<Rgb>& target);

}  // namespace voxtone::accuracy
