// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layer profiles (layer_profile.h) of resins known by absorption, scattering and phase function: made without a
// laboratory.
//
// A layer is index-matched on both sides, as in the laminate equations (Hasan et al. 2010, Sec. 5, ignore Fresnel's),
// and lit by diffuse light at one point. How far light spreads is traced (layer_paths.h); how much of it comes out is
// solved by adding-doubling and the traced light scaled to that, as the paper scales what it measured to albedos (Sec.
// 4). Light that passes straight through is exact: within r = thickness * sqrt(v^2 - 1) of the entry it is 2 (E3(tau) -
// E3(tau v) / v^2).
//
// Refractive surfaces come in two ways. `smooth_surface` is a layer of its own: diffuse light from within is turned
// back in part (0.596 where eta is 1.5) where it meets it. That is rough, because light that a surface lets in is not
// diffuse but runs within 42 degrees of the normal. `bounded_totals` are a layer's together with the surface above it,
// solved as one; only what passes below it is taken as diffuse. R of a laminate under either is what the predictors
// of voxtone call appearance: light that leaves / light that was let in, without the mirror reflection; 1 for a body
// that absorbs nothing.
//
// Cannot be seen: light between layers is taken as diffuse. docs/profiles.md says what that costs.
#pragma once

#include <vector>

#include "optics/monte_carlo/layer_paths.h"
#include "optics/profiles/layer_profile.h"

namespace voxtone::optics {

/// Shares of diffuse light on the top of an index-matched laminate.
struct DiffuseTotals {
    double R = 0, T = 0;
    double T_direct = 0;  ///< of T: never scattered
};

/// Exact to 1e-5 for |g| <= 0.5 (adding-doubling). eta_top and eta_bottom must be 1: contract.
[[nodiscard]] DiffuseTotals diffuse_totals(const LayerScene& scene);

/// Of a homogeneous layer under a smooth surface to air, index-matched below. Downwards, one unit is the light that the
/// surface let in; upwards, diffuse light from below.
struct BoundedTotals {
    double R_top = 0, T_down = 0;
    double R_bottom = 0, T_up = 0;
};

/// By adding-doubling with that many directions, a multiple of 4. T_up = (1 - s) T_down, s as in smooth_surface
/// (reciprocity).
[[nodiscard]] BoundedTotals bounded_totals(const Medium& medium, double g, double eta, double thickness_mm,
                                           int directions = 32);

struct ResinProfile {
    double thickness_mm = 0;
    std::vector<double> T, R;  ///< Hankel coefficients; the first are the exact totals
    TracedProfile traced;      ///< as it was traced
    [[nodiscard]] HomogeneousLayer layer() const { return {T, R, thickness_mm}; }
};

/// Of a homogeneous layer.
[[nodiscard]] ResinProfile resin_profile(const Medium& medium, double g, double thickness_mm, const HankelGrid& grid,
                                         const LayerPathOptions& options = {}, const Progress* progress = nullptr);

/// A smooth surface between air above and resin of index eta >= 1 below; turned over it is one below a laminate. With
/// R_bottom = integral of 2 nu r(nu) dnu, T^2 = 1 - R_bottom; R_top = 0, what is mirrored is not counted. Since T
/// stands for the way in and the way out, T of a laminate is right where there is a surface on both sides or on none.
[[nodiscard]] LayerProfile smooth_surface(double eta, std::size_t coefficients);

}  // namespace voxtone::optics
