// SPDX-License-Identifier: GPL-3.0-or-later
//
// Diffuse light under a smooth surface, coefficient by coefficient, and back (J. L. Saunderson, "Calculation of the
// color of pigmented plastics", 1942, without the mirror reflection).
//
// With s the share of diffuse light from within that the surface turns back, a laminate that reflects R shows
//
//   seen = (1 - s) R / (1 - s R)    and    R = seen / (1 - s + s seen)
//
// which is smooth_surface (resin_profile.h) upon it. Both grow steadily and map 0 to 0 and 1 to 1.
//
// What it cannot see: light that a surface lets in is not diffuse, but runs within 42 degrees of the normal
// (docs/laminate-search.md says what that costs).
#pragma once

namespace voxtone::optics {

/// R <= 1, 0 <= s < 1.
[[nodiscard]] inline double seen_through_surface(double R, double s) { return (1 - s) * R / (1 - s * R); }
/// The inverse. Values so negative that no R shows them (noise) go on along the straight line from 0.
[[nodiscard]] inline double behind_surface(double seen, double s) {
    return seen >= 0 ? seen / (1 - s + s * seen) : seen / (1 - s);
}

/// Share of diffuse light from within that is turned back: 0.596 where eta is 1.5; 0 where eta is 1.
[[nodiscard]] double internal_diffuse_reflectance(double eta);

}  // namespace voxtone::optics
