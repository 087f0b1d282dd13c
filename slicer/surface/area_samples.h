// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points spread evenly over a surface: a triangle with the probability of its share of the area, a point anywhere on it
// (the unit square's upper half folded onto the lower). Sample i is a function of seed and i alone (base/random.h).
// Threads: const members may be called from any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

class AreaSamples {
public:
    /// Of a surface with at least one triangle.
    explicit AreaSamples(const VisibleSurface& surface);

    [[nodiscard]] double area_mm2() const { return area_up_to_.back(); }

    /// corner0 + u (corner1 - corner0) + v (corner2 - corner0) of a triangle of the surface.
    struct Sample {
        std::uint32_t triangle;
        double u, v;
    };
    [[nodiscard]] Sample at(std::uint64_t seed, std::uint64_t i) const;

private:
    std::vector<double> area_up_to_;  ///< of triangles 0 .. t
};

}  // namespace voxtone::slicer
