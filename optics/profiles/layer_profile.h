// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers known by how light spreads in them: reflection and transmission profiles as discrete Hankel coefficients.
//
// A profile f(r) is the light per mm^2 that leaves a layer at a distance r from where one unit of diffuse light entered
// (opposite side: T; same side: R). Its Hankel coefficients f^(k_i) are those of a disc of radius `reach_mm`; the first
// one is taken at k = 0: the total reflectance or transmittance. Layers one upon another multiply coefficient by
// coefficient (Hasan et al. 2010, Sec. 5; Donner and Jensen 2005), with R' the reflection from below:
//
//   T_12 = T_1 T_2 / (1 - R'_1 R_2),   R_12 = R_1 + T_1^2 R_2 / (1 - R'_1 R_2),   R'_12 = R'_2 + T_2^2 R'_1 / (1 - R'_1
//   R_2)
//
// A homogeneous layer of any thickness follows from one of a known thickness by Kubelka and Munk's equations, taken for
// each coefficient by itself (Sec. 5.2). K and S are the limits of (1 - R - T) / h and R / h as h goes to 0. The paper
// halves the layer until it is thin; here they are taken in closed form, from the two ways of lighting a layer from
// both sides, alike and opposed:
//
//   x = (1 - T - R) / (1 + T + R) = (K / gamma) t,   y = (1 - T + R) / (1 + T - R) = (gamma / K) t,   t = tanh(gamma h
//   / 2)
//
// with gamma^2 = K (K + 2 S) and gamma / K standing for (K + 2 S) / gamma, which stays finite where K = 0. So nothing
// is lost to rounding for layers that absorb nothing, and T keeps a relative error of about 1e-15 / (1 - R) however
// small it is.
//
// Coefficients are kept in [0, 1]. What it cannot see: in which direction light passes from layer to layer, and a
// refractive surface between them. A coefficient T that is lost in noise (0) makes every thinner layer opaque there
// too.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voxtone::optics {

/// Of one channel. All have as many coefficients.
struct LayerProfile {
    std::vector<double> T, R_top, R_bottom;
    [[nodiscard]] std::size_t size() const { return T.size(); }
};

/// No layer at all: T = 1, R = 0.
[[nodiscard]] LayerProfile no_layer(std::size_t coefficients);
/// One layer upon another. Contract: as many coefficients.
[[nodiscard]] LayerProfile laminate(const LayerProfile& upper, const LayerProfile& lower);
/// Upside down.
[[nodiscard]] inline LayerProfile turned_over(const LayerProfile& layer) {
    return {layer.T, layer.R_bottom, layer.R_top};
}

/// A homogeneous material of any thickness.
class HomogeneousLayer {
public:
    /// From a layer of a known thickness > 0, finite. T and R are clamped to [0, 1] and, where T + R is above 1, scaled
    /// down by their sum; `clamped` says by how much a coefficient was changed at most.
    HomogeneousLayer(std::span<const double> T, std::span<const double> R, double thickness_mm);
    /// 0 (no layer) to infinity (a half-space).
    [[nodiscard]] LayerProfile of_thickness(double mm) const;
    [[nodiscard]] std::span<const double> K() const { return K_; }
    [[nodiscard]] std::span<const double> S() const { return S_; }
    [[nodiscard]] double clamped() const { return clamped_; }

private:
    std::vector<double> K_, S_;  ///< mm^-1
    double clamped_ = 0;
};

}  // namespace voxtone::optics
