// SPDX-License-Identifier: GPL-3.0-or-later
//
// What comes out of a refractive surface, from the reflection kernel R of what is under it (adding_doubling.h).
//
//   rho_ij = t_i [ (1 - R diag(r) C)^-1 R ]_ij t_j / eta^2 = pi L_o / E
//
// the azimuthally averaged reflectance factor for light from direction j and a view along i: 1 for a perfect diffuser,
// the mirror reflection left out (Iser, Rittig, Wilkie 2025, Sec. 3.1). Symmetric in i and j (reciprocity); 0 for
// trapped directions.
#pragma once

#include <Eigen/Core>

#include "optics/layered/adding_doubling.h"
#include "optics/layered/angular_grid.h"
#include "optics/scene/backing.h"

namespace voxtone::optics {

/// All rho_ij on the grid.
[[nodiscard]] Eigen::MatrixXd reflectance_factors(const AngularGrid& grid, const Eigen::MatrixXd& R);

/// Flux out through the surface / flux in through it under uniform diffuse light (layered_appearance.h): for a base
/// that has no lower side,
[[nodiscard]] double appearance_of(const AngularGrid& grid, const Eigen::MatrixXd& R);
/// and for a slab with a smooth lower surface over a backing.
[[nodiscard]] double appearance_of(const AngularGrid& grid, const LayerResponse& slab, Backing backing,
                                   double sent_back = 0);

}  // namespace voxtone::optics
