// SPDX-License-Identifier: GPL-3.0-or-later
//
// How smooth a body's surface is, from place to place. A jetted surface that nothing touched is glossy; where support
// material lay on it, it is matt.
#pragma once

#include "optics/scene/boundary.h"

namespace voxtone::optics {

class SurfaceFinish {
public:
    virtual ~SurfaceFinish() = default;
    /// The alpha of GGX (rough_interface.h) at a place of the surface, mm from the volume's corner; in [0, 1), 0 is
    /// smooth. `outward`: the geometric normal there.
    [[nodiscard]] virtual double roughness(const Point& at, const Point& outward) const = 0;
};

/// The same everywhere.
class EvenFinish : public SurfaceFinish {
public:
    explicit EvenFinish(double roughness) : roughness_(roughness) {}
    [[nodiscard]] double roughness(const Point&, const Point&) const override { return roughness_; }

private:
    double roughness_;
};

}  // namespace voxtone::optics
