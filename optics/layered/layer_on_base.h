// SPDX-License-Identifier: GPL-3.0-or-later
//
// rho(45 -> 0) of one layer upon a base, with its exact derivatives by what both are made of: what a calibration fits.
//
// The modes of layer_modes.h, cut so that what is needed by many patches is made once:
//   OrdinateSlab    a layer, wherever it lies
//   OrdinateBase    the law of what lies below, V = Y U; of layers upon layers each is made upon the one below it
//   OrdinateLayer   the uppermost layer seen from below, V = -P U + ..., for all bases under it; one Cholesky factor a
//                   base is left
//
// With D = (1 - r)/(1 + r) the surface's law in modes, A = C + W^-1 D W^-T and N = S A^-1 S (C, S: layer_modes.h),
//
//   (P + Y) U(T) = W S A^-1 W^-1 e,   P = W (C - N) W^T,   u(0) = A^-1 (W^-1 e + S u(T))
//
// for light e from 45 degrees or, by reciprocity, from the eye. For two such solutions 1 and 2 a change of the layer
// changes rho by the integral over its depth of U1 dE U2 - V1 dF V2. In modes every term is a product of two sinh or
// two cosh, whose integrals are divided differences of C and S by Lambda: closed forms, no differentiation of
// eigenvectors. So both derivatives of a patch by its layer, and both by its base, cost less than rho itself. Layers
// farther below see u(T) = (y + C)^-1 S u(0) of the one above.
//
// Units mm, mm^-1. Range: as layer_modes.h; a medium of less than 1e-7 per mm counts as scattering that much. Error of
// rho: as layered_appearance.h; of the derivatives by albedo and by ln sigma_t: 1e-6 of the largest, tested against
// differences. What it cannot see: what is not plane-parallel and endless sideways.
#pragma once

#include <memory>

#include "optics/layered/layer_modes.h"

namespace voxtone::optics {

/// U at a level, for light from 45 degrees, times what makes it rho, and from the eye.
using OrdinatePair = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, max_ordinates, 2>;

/// rho and its derivatives by sigma_a and sigma_s (mm) of the layer and of the base's uppermost.
struct LayerReflectance {
    double rho = 0;
    Medium by_layer, by_base;
    OrdinatePair under;  ///< light below the base's uppermost layer, where there is one
};

class OrdinateSlab {
public:
    OrdinateSlab(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, bool with_derivatives);

private:
    friend class OrdinateBase;
    friend class OrdinateLayer;
    /// By its medium, for two solutions in modes: `a` at the upper side, `b` at the lower.
    [[nodiscard]] Medium slopes(const OrdinatePair& a, const OrdinatePair& b) const;
    bool with_derivatives_;
    double sigma_t_, albedo_, truncated_, thickness_mm_;
    OrdinateVector lambda_, C_, S_;
    OrdinateMatrix W_, W_inverse_, same_end_, other_end_;
};

class OrdinateBase {
public:
    /// Of which nothing is asked; its light p is taken as 0.
    explicit OrdinateBase(const Admittance& law) : Y_(law.Y), with_derivatives_(true) {}
    /// A half-space.
    OrdinateBase(const OrdinatePlan& plan, const Medium& medium, bool with_derivatives);
    /// A slab upon another base.
    OrdinateBase(std::shared_ptr<const OrdinateSlab> slab, const OrdinateBase& below);
    OrdinateBase(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, const Admittance& below,
                 bool with_derivatives)
        : OrdinateBase(std::make_shared<const OrdinateSlab>(plan, medium, thickness_mm, with_derivatives),
                       OrdinateBase(below)) {}

    /// Derivatives of rho by the uppermost layer, from the light above it, which becomes that below.
    [[nodiscard]] Medium slopes(OrdinatePair& light) const;

private:
    friend class OrdinateLayer;
    std::shared_ptr<const OrdinateSlab> slab_;
    OrdinateMatrix Y_, Y_absorption_, Y_scattering_, across_;
    bool with_derivatives_;
};

class OrdinateLayer {
public:
    /// `plan` looks along 45 and 0 degrees (directional_plan).
    OrdinateLayer(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, bool with_derivatives);
    /// Derivatives are 0 unless both were made with them.
    [[nodiscard]] LayerReflectance upon(const OrdinateBase& base) const;

private:
    OrdinateSlab slab_;
    OrdinatePair light_, source_;
    OrdinateVector eye_;
    OrdinateMatrix L_, P_;
};

}  // namespace voxtone::optics
