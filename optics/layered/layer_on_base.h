// SPDX-License-Identifier: GPL-3.0-or-later
//
// rho(45 -> 0) of one layer upon a base, with its exact derivatives by what both are made of: what a calibration fits.
//
// The modes of layer_modes.h, cut so that what is needed by many patches is made once:
//   OrdinateBase    the law of a base, V = Y U, and dY; for all patches on it
//   OrdinateLayer   a layer seen from below, V = -P U + ..., for all bases under it; one Cholesky factor a base is left
//
// With D = (1 - r)/(1 + r) the surface's law in modes, A = C + W^-1 D W^-T and N = S A^-1 S (C, S: layer_modes.h),
//
//   (P + Y) U(T) = W S A^-1 W^-1 e,   P = W (C - N) W^T,   u(0) = A^-1 (W^-1 e + S u(T))
//
// for light e from 45 degrees or, by reciprocity, from the eye. For two such solutions 1 and 2 a change of the layer
// changes rho by the integral over its depth of U1 dE U2 - V1 dF V2. In modes every term is a product of two sinh or
// two cosh, whose integrals are divided differences of C and S by Lambda: closed forms, no differentiation of
// eigenvectors. So both derivatives of a patch by its layer, and both by its base, cost less than rho itself.
//
// Units mm, mm^-1. Range: as layer_modes.h; a medium of less than 1e-7 per mm counts as scattering that much. Error of
// rho: as layered_appearance.h; of the derivatives by albedo and by ln sigma_t: 1e-6 of the largest, tested against
// differences. What it cannot see: what is not plane-parallel and endless sideways.
#pragma once

#include "optics/layered/layer_modes.h"

namespace voxtone::optics {

/// rho and its derivatives by sigma_a and sigma_s (mm) of the layer and of the base.
struct LayerReflectance {
    double rho = 0;
    Medium by_layer, by_base;
};

class OrdinateBase {
public:
    /// A half-space.
    OrdinateBase(const OrdinatePlan& plan, const Medium& medium, bool with_derivatives);
    /// A slab upon something whose law is `below` (its light p is taken as 0).
    OrdinateBase(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, const Admittance& below,
                 bool with_derivatives);

private:
    friend class OrdinateLayer;
    OrdinateMatrix Y_, Y_absorption_, Y_scattering_;
    bool with_derivatives_;
};

class OrdinateLayer {
public:
    /// `plan` looks along 45 and 0 degrees (directional_plan) and must outlive this.
    OrdinateLayer(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, bool with_derivatives);
    /// Derivatives are 0 unless both were made with them.
    [[nodiscard]] LayerReflectance upon(const OrdinateBase& base) const;

private:
    const OrdinatePlan* plan_;
    bool with_derivatives_;
    double sigma_t_, albedo_, truncated_, depth_, scale_;
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, max_ordinates, 2> W_inverse_e_, light_, source_;
    OrdinateVector lambda_, C_, S_;
    OrdinateMatrix W_, L_, P_, same_end_, other_end_;
};

}  // namespace voxtone::optics
