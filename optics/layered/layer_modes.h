// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layered light transport by the modes of each layer: the same discrete equations that adding-doubling solves, in
// closed form, tens of times faster. After Chandrasekhar's discrete ordinates (1950); in this even/odd symmetric form
// after Nakajima and Tanaka 1986 (JQSRT 35:13).
//
// With x+ and x- the radiances down and up, each times sqrt(c), let U = x+ + x- and V = x+ - x-. In a homogeneous layer
//
//   dU/dtau = -F V,  dV/dtau = -E U,   E = 1/nu - a (S_same + S_opposite),  F = 1/nu - a (S_same - S_opposite),
//   S = s h s / 4,  s = sqrt(c)/nu,  a = albedo,  tau = optical depth
//
// with E and F symmetric, F positive definite. The modes, U = W^-T u and V = W v with W^T F W = 1 and
// W^-1 E W^-T = Lambda diagonal, decouple it: u' = -v, v' = -Lambda u. Whatever lies below a level is one affine law
// there, V = Y U + p, with a symmetric admittance Y and light p that comes from below. A half-space has
// Y = W Lambda^(1/2) W^T; a layer of optical depth t turns the law at its lower side, in modes (y, p), into
//
//   y' = C - s (C + y)^-1 s,   C = sqrt(Lambda) coth(sqrt(Lambda) t)
//   p' = s (C + y)^-1 p,       s = sqrt(Lambda) / sinh(sqrt(Lambda) t)
//
// Range: 0 <= a <= 1, any thickness; a layer thinner than 1e-9 in optical depth counts as not there. Error against
// adding-doubling on the same nodes: below 1e-8, tested.
#pragma once

#include <Eigen/Core>

#include "optics/layered/angular_grid.h"
#include "optics/layered/phase.h"
#include "optics/media/resins.h"
#include "optics/numerics/symmetric_eigen.h"

namespace voxtone::optics {

/// What is prepared once for a phase function, a refractive index and a set of directions. Every weight of the grid
/// must be positive.
class OrdinatePlan {
public:
    OrdinatePlan(const AngularGrid& grid, double g, int terms);
    [[nodiscard]] const AngularGrid& grid() const { return grid_; }
    [[nodiscard]] const PhaseMatrices& phase() const { return phase_; }
    [[nodiscard]] int size() const { return grid_.size(); }
    /// S_same + S_opposite and S_same - S_opposite: -dE/da and -dF/da.
    [[nodiscard]] const OrdinateMatrix& even() const { return even_; }
    [[nodiscard]] const OrdinateMatrix& odd() const { return odd_; }

private:
    friend class LayerModes;
    friend struct Admittance;
    AngularGrid grid_;
    PhaseMatrices phase_;
    OrdinateVector inverse_nu_, sqrt_c_;
    OrdinateMatrix even_, odd_;  // S_same + S_opposite, S_same - S_opposite
};

/// The law V = Y U + p of what lies below a level.
struct Admittance {
    OrdinateMatrix Y;
    OrdinateVector p;

    /// Nothing comes back: a perfect absorber of the same refractive index.
    [[nodiscard]] static Admittance black(const OrdinatePlan& plan);
    /// A smooth lower surface to air, with uniform light of radiance 1 (`lit`) or 0 below it.
    [[nodiscard]] static Admittance air(const OrdinatePlan& plan, bool lit);
    /// A smooth lower surface to air, and under the air a sheet that sends back this share of what leaves, diffusely.
    [[nodiscard]] static Admittance white_sheet(const OrdinatePlan& plan, double share = 1);
};

/// The modes of one medium. It must scatter or absorb.
class LayerModes {
public:
    LayerModes(const OrdinatePlan& plan, const Medium& medium);
    [[nodiscard]] Admittance half_space() const;
    /// The law at the upper side of a layer, given the law at its lower side.
    [[nodiscard]] Admittance over(const Admittance& below, double thickness_mm) const;
    /// Decay per mm of each mode, ascending; the first is the reciprocal of the diffusion length. For tests, which know
    /// that length otherwise.
    [[nodiscard]] OrdinateVector decay_per_mm() const;
    /// Lambda, ascending; W; W^-1; and the optical depth of a mm, without the forward peak of the phase function.
    [[nodiscard]] const OrdinateVector& lambda() const { return lambda_; }
    [[nodiscard]] const OrdinateMatrix& W() const { return W_; }
    [[nodiscard]] const OrdinateMatrix& W_inverse() const { return W_inverse_; }
    [[nodiscard]] double depth_per_mm() const { return sigma_t_; }

private:
    double sigma_t_;
    OrdinateVector lambda_;  // squares of the decays per optical depth
    OrdinateMatrix W_, W_inverse_;
};

}  // namespace voxtone::optics
