// SPDX-License-Identifier: GPL-3.0-or-later
//
// Adding-doubling: the exact solution of layered light transport on a set of directions, and the yardstick of every
// other model here. Van de Hulst 1963; the form follows Prahl 1995, Ch. 5 of Optical-Thermal Response of
// Laser-Irradiated Tissue, with the direct beam kept apart from what was scattered, so that directions of weight zero
// (exact views) are allowed.
//
// A kernel A_ij gives the radiance I_i = sum_j A_ij c_j I_j, in units where a perfect diffuser has A = 1. Layers are
// matched in index to each other; the refractive surface belongs to what is around the stack (directional.h).
//
// Range: 0 <= albedo <= 1, any thickness, |g| < 1. Error on given nodes: below 1e-9. What the nodes cost:
// angular_grid.h. Time: some 30 doublings of a dozen N^3 operations a layer; layer_modes.h solves the same equations
// faster.
#pragma once

#include <Eigen/Core>

#include "optics/layered/angular_grid.h"
#include "optics/layered/phase.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

/// What a layer does to light: scattered reflection and transmission, lit from above and from below, and the direct
/// beam.
struct LayerResponse {
    Eigen::MatrixXd R_above, R_below;
    Eigen::MatrixXd D_down, D_up;
    Eigen::ArrayXd direct;  ///< exp(-tau / nu), tau without the forward peak of the phase function
};

class AddingDoubling {
public:
    /// `terms`: Legendre terms of the phase function. Energy is conserved exactly for any number of them.
    AddingDoubling(const AngularGrid& grid, double g, int terms);

    [[nodiscard]] const AngularGrid& grid() const { return grid_; }

    /// A homogeneous layer.
    [[nodiscard]] LayerResponse layer(const Medium& medium, double thickness_mm) const;

    /// Reflection of a half-space: doubled until nothing changes. It must scatter or absorb.
    [[nodiscard]] Eigen::MatrixXd half_space(const Medium& medium) const;

    /// One layer upon another.
    [[nodiscard]] LayerResponse add(const LayerResponse& upper, const LayerResponse& lower) const;

    /// Reflection of a layer upon something that reflects R_below.
    [[nodiscard]] Eigen::MatrixXd over(const LayerResponse& upper, const Eigen::MatrixXd& R_below) const;

private:
    struct Symmetric;  // response of a homogeneous layer: the same from both sides
    [[nodiscard]] Symmetric thin(double albedo, double depth) const;
    [[nodiscard]] Symmetric doubled(const Symmetric& half) const;

    AngularGrid grid_;
    PhaseMatrices phase_;
};

}  // namespace voxtone::optics
