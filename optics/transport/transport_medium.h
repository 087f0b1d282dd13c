// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a medium is to the transport predictor: the albedo with which its few directions give the exact half-space.
//
// The linear phase function, 64 directions and cells of finite depth make a homogeneous half-space a little too dark,
// by at most 0.004, an amount that depends on the albedo and on the extinction. Here the same discrete equations are
// solved for the half-space (one layer of cells by a linear system, then doubling), and the albedo alpha* is found with
// which they give the appearance that the exact solution (layered_appearance.h) has at alpha. alpha* = 1 at alpha = 1.
// With the interpolated alpha* a half-space is exact within 3e-4 (tested). Range: extinctions up to 100 / mm; beyond,
// the value there holds.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "optics/grid/transport_directions.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

/// Coefficients of the discrete equations in one channel, mm^-1.
struct TransportMedium {
    float sigma_t = 0;  ///< without the forward peak
    float sigma_s = 0;  ///< without the forward peak
    float linear = 0;   ///< g' of the scattering source sigma_s (phi + 3 g' Omega . J)
    float apart = 0;    ///< share of a cell's faces behind which another medium lies
};

/// The medium with the forward peak taken as not scattered and nothing else changed: what diffusion wants.
[[nodiscard]] TransportMedium similar_medium(const DirectionSet& set, const Medium& medium);

/// g' with which light spreads sideways through cells of these edges as it does through the medium.
///
/// A weight of the differences below 1 widens diffusion. psi of a cell lies nearer to the face that light leaves by:
/// psi - (psi_in + psi_out) / 2 = (psi_out - psi_in) (1 - theta) / (2 (1 + theta)), which adds |Omega_a| h_a (1 -
/// theta) / (2 (1 + theta)) d^2 psi / dx_a^2 to the balance of a direction and, with <|Omega_a|> = 1/2 over the sphere,
///   D_art = h (1 - theta) / (4 (1 + theta)),   h the mean of the edges,
/// to D = 1 / (3 sigma_tr), sigma_tr = sigma_t - g' sigma_s: 8 % of white's in blue on cells of 0.085 mm, 32 % at 100
/// per mm. The source takes it back, as if transport's mean free path were shorter by r = D_art / D:
///   g'' = g' - (sigma_s / sigma_t)^10 sigma_tr / sigma_t r / (1 - r).
/// Free paths, losses and what a half-space looks like stay. Exact where nothing is absorbed; where much is, light does
/// not come far enough to be diffuse and the exponential fit of transport_sweep.h holds instead: the exponent is that
/// of 0, 2, 4, 6 and 10 with which no case of the suite gets worse by more than 0.015 on whole cells
/// (`predictor_accuracy
/// --fine 0 compare`; its mean is 0.85 with each of them and 0.89 with g'). Held at -1/3 as g' is
/// (transport_directions.h): beyond 150 per mm of white on cells of 0.085 mm diffusion is wide again.
[[nodiscard]] double anti_diffusive_linear(const DirectionSet& set, const std::array<double, 3>& edge_mm, double theta,
                                           double sigma_t, double sigma_s);

/// fit of a cell of a wide medium (transport_sweep.h): sigma_a in mm^-1, mean way in mm, weight of the differences.
[[nodiscard]] double cell_fit(double sigma_a, double way, double theta = 1);
/// The same of a cell that others lie beside, by the share `apart` of its faces. `ways`: of the direction from side to
/// side along each axis, mm.
[[nodiscard]] double lump_fit(double sigma_a, const std::array<double, 3>& ways, double theta, double apart);
/// The mean over a box of light 1 that comes in evenly through its sides in one direction and is absorbed on its way:
///   <exp(-sigma_a s)>,   s > t in a share prod_a (1 - t / ways_a) of the box.
/// Relative error below 1e-6 to sigma_a of ten by the shortest way, 1e-3 beyond.
[[nodiscard]] double mean_in_box(double sigma_a, const std::array<double, 3>& ways);

class TransportMedia {
public:
    /// For cells of these edges; `theta` as in transport_sweep.h.
    TransportMedia(const DirectionSet& set, const std::array<double, 3>& edge_mm, double theta = 1);

    [[nodiscard]] TransportMedium operator()(const Medium& medium) const;
    /// The same in double precision: sigma_t, sigma_s, g'.
    [[nodiscard]] std::array<double, 3> exact(const Medium& medium) const;
    /// 1 - alpha* for this albedo and extinction.
    [[nodiscard]] double loss(double albedo, double sigma_t) const;
    /// Appearance of a half-space by the discrete equations.
    [[nodiscard]] double discrete_half_space(double albedo, double sigma_t) const;

private:
    DirectionSet set_;
    std::array<double, 3> edge_mm_;
    double theta_;
    std::vector<double> ratio_;  ///< (1 - alpha*) / (1 - alpha) at [extinction][albedo]
};

/// The same tables for the same cells, made once.
[[nodiscard]] std::shared_ptr<const TransportMedia> shared_media(const DirectionSet& set,
                                                                 const std::array<double, 3>& edge_mm,
                                                                 double theta = 1);

}  // namespace voxtone::optics
