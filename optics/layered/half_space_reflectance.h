// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an endlessly thick piece of one medium reflects as an instrument reads it: a function of its albedo alone, for
// fixed g and eta. Tabulated over sqrt(1 - albedo), in which it is nearly straight at white (it falls there as the
// root), by the modes of layered_appearance.h; a spline between.
//
//   directional 45/0   pi L_o / E for light from 45 degrees and a view along the normal
//   diffuse/8          the same for uniform diffuse light; the view is taken along the normal, where 8 degrees see the
//                      same within 1e-3
//
// Relative to a perfect diffuser; the reflection of the surface is left out. Range: albedo in [0, 1]. Error of the
// table: 1e-6 (tested). Immutable after construction.
#pragma once

#include "optics/media/resins.h"
#include "optics/numerics/bicubic_table.h"

namespace voxtone::optics {

class HalfSpaceReflectance {
public:
    /// g in (-1, 1), eta >= 1.
    HalfSpaceReflectance(double g, double eta, MeasuringGeometry geometry);

    struct Value {
        double rho, by_absorption, by_scattering;  ///< derivatives by sigma_a and sigma_s, mm
    };
    [[nodiscard]] double operator()(const Medium& medium) const;
    [[nodiscard]] Value with_gradient(const Medium& medium) const;

private:
    BicubicTable table_;
};

}  // namespace voxtone::optics
