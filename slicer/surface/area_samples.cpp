// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/area_samples.h"

#include <algorithm>

#include "base/contracts.h"
#include "base/random.h"
#include "slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

AreaSamples::AreaSamples(const VisibleSurface& surface) {
    VOXTONE_EXPECT(!surface.triangles.empty());
    double sum = 0;
    for (const Triangle& t : surface.triangles) area_up_to_.push_back(sum += area(surface.positions_mm, t));
}

AreaSamples::Sample AreaSamples::at(std::uint64_t seed, std::uint64_t i) const {
    RandomStream random(seed, i);
    const auto found = std::lower_bound(area_up_to_.begin(), area_up_to_.end(), random.uniform() * area_mm2());
    // Rounding may take the last of them past the sum.
    const auto t = std::min<std::ptrdiff_t>(found - area_up_to_.begin(), std::ptrdiff_t(area_up_to_.size()) - 1);
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return {static_cast<std::uint32_t>(t), u, v};
}

}  // namespace voxtone::slicer
