// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a fit of observer and resins starts, and what it leans on where patches are few: bands evenly over the visible
// range, seen by rough bells for the three cones' responses; absorption of C, M, Y, K and W as such inks have it; of
// any other role after the reddest, greenest and bluest light of the patch that holds most of it. Curves are ours,
// drawn by hand; nothing was fitted to them.
#pragma once

#include "calibration/chart/chart_data.h"
#include "calibration/chart/observer_model.h"

namespace voxtone::calibration {

/// The resin that scattering is told relative to: W, else the one whose patches are the lightest.
[[nodiscard]] Eigen::Index white_resin(const ChartData& data);

/// The mixture that holds most of a resin.
[[nodiscard]] Eigen::Index purest_patch(const ChartData& data, Eigen::Index resin);

/// The bands: wavelength of one, nm; weights to XYZ relative to white of all, columns sum to 1.
[[nodiscard]] double start_nm(Eigen::Index channel, Eigen::Index channels);
[[nodiscard]] Eigen::MatrixX3d start_weights(Eigen::Index channels);
/// Absorption over scattering of what reflects so much, by Kubelka and Munk's K/S, and of what has this colour.
[[nodiscard]] double absorption_by_reflectance(double rho);
[[nodiscard]] double absorption_by_colour(const Eigen::Vector3d& lab, const Eigen::Vector3d& white, double nm);

[[nodiscard]] ObserverParts observer_start(const ChartData& data, Eigen::Index channels);
/// Of laminates: absorption from those that show most of a resin; all scattering per mm.
[[nodiscard]] ObserverParts laminate_start(const ChartData& data, Eigen::Index channels);

}  // namespace voxtone::calibration
