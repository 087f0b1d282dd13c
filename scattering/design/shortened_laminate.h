// SPDX-License-Identifier: GPL-3.0-or-later
//
// A laminate without the depth that light hardly reaches: it leaves room in thin parts, and laminates that differ only
// in what is not seen come nearer to each other.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

/// Layers are taken from the bottom, then the lowest one left is thinned (to a thousandth of itself), as long as
/// `distance` stays at or below `most`. A laminate that is above it from the start is given back as it is.
[[nodiscard]] std::vector<LaminateLayer> shortened_laminate(
    std::vector<LaminateLayer> layers, double most,
    const std::function<double(std::span<const LaminateLayer>)>& distance);

}  // namespace voxtone::scattering
