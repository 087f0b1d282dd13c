// SPDX-License-Identifier: GPL-3.0-or-later
//
// Total reflection and transmission of a slab in air with smooth surfaces on both sides: what an integrating sphere
// sees.
//
// UR1, UT1: collimated normal incidence; URU, UTU: Lambertian incidence; mirror reflection and unscattered light
// included (incoherent multiple reflections; the notation of Prahl 1995). All four are shares of the incident flux.
// Error, tested against converged tables: 8 + 8 directions and 32 terms below 1e-5 for |g| <= 0.5; 16 + 16 directions
// and 64 terms below 1e-4 for g = 0.875.
//
// Published tables are of slabs in air: adding-doubling is held to them through it.
#pragma once

#include "optics/layered/adding_doubling.h"

namespace voxtone::optics::testing {

/// Share of the flux from each direction that is scattered out: eta^2 sum_i c_i rho_ij. Without the mirror reflection.
[[nodiscard]] Eigen::ArrayXd hemispherical_reflectance(const AngularGrid& grid, const Eigen::MatrixXd& rho);

struct FluxTotals {
    double UR1 = 0, UT1 = 0, URU = 0, UTU = 0;
};

/// What is reflected or transmitted without having been scattered by a slab of optical depth tau (may be infinite).
[[nodiscard]] FluxTotals unscattered(double eta, double tau);

/// Totals of a slab. The grid must have the normal direction, mu = 1.
[[nodiscard]] FluxTotals slab_totals(const AngularGrid& grid, const LayerResponse& slab);

/// Totals of a half-space that reflects R.
[[nodiscard]] FluxTotals half_space_totals(const AngularGrid& grid, const Eigen::MatrixXd& R);

}  // namespace voxtone::optics::testing
