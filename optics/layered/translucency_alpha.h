// SPDX-License-Identifier: GPL-3.0-or-later
//
// Translucency alpha, of ISO 19307:2026 after P. Urban, T. Tanksale, A. Brunton et al., "Redefining A in RGBA: towards
// a standard for graphical 3D printing", ACM Trans. Graph. 38:21 (2019): one number in [0, 1] that says how far light
// gets in a material, 0 where it is clear, 1 where it is opaque. Of a grey homogeneous material that scatters evenly to
// all sides, with a and s in 1/cm (the paper names no unit; no other makes sense of its examples),
//
//   eta = 0.4 a + s,     A = (1 - exp(-0.0153 eta))^0.6.
//
// Any other sample has the alpha of the grey that reads the same. Two of the standard's readings tell a and s of a
// grey: what a slab of 4 mm throws back on a white sheet, and what of diffuse light comes through it; its two apertures
// tell the same once more, and are not looked at here.
#pragma once

#include <vector>

#include "optics/media/resins.h"

namespace voxtone::optics {

inline constexpr double translucency_slab_mm = 4;

/// eta of a grey that absorbs and scatters so, 1/cm.
[[nodiscard]] double translucency_eta(double absorption_per_cm, double scattering_per_cm);
/// `eta_per_cm`: as above, >= 0. And back; alpha in [0, 1), of 1 infinity.
[[nodiscard]] double translucency_alpha(double eta_per_cm);
[[nodiscard]] double translucency_eta_per_cm(double alpha);

/// What a slab shows, each a share of the light that entered it (layered_appearance.h).
struct SlabReading {
    double on_white = 0;  ///< what leaves it upwards where a perfect white sheet lies below, air between
    double through = 0;   ///< what of diffuse light from below leaves it upwards
};

/// Which grey reads as a slab does. Readings of greys are tabulated once: 32 ratios of absorption to scattering, 40
/// extinctions; the alpha of a grey within is found to 0.003 (tested).
class TranslucencyScale {
public:
    /// Of materials of this refractive index; thinner slabs are read as greys as thin are.
    explicit TranslucencyScale(double eta, double slab_mm = translucency_slab_mm);
    /// eta of the grey that reads like this, per cm; at the ends of the table the nearest.
    [[nodiscard]] double eta_per_cm(const SlabReading& reading) const;

private:
    struct Row {
        double absorbed;  ///< a / s
        std::vector<double> log_through, on_white;
    };
    std::vector<double> log_extinction_;  ///< of a + s, 1/mm
    std::vector<Row> rows_;               ///< the more absorbed the further down
};

}  // namespace voxtone::optics
