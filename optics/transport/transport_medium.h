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

#include "optics/media/resins.h"
#include "optics/transport/transport_directions.h"

namespace voxtone::optics {

/// Coefficients of the discrete equations in one channel, mm^-1.
struct TransportMedium {
    float sigma_t = 0;  ///< without the forward peak
    float sigma_s = 0;  ///< without the forward peak
};

/// The medium with the forward peak taken as not scattered and nothing else changed: what diffusion wants.
[[nodiscard]] TransportMedium similar_medium(const DirectionSet& set, const Medium& medium);

/// fit of a cell (transport_sweep.h): sigma_a in mm^-1, mean way in mm, weight of the differences.
[[nodiscard]] double cell_fit(double sigma_a, double way, double theta = 1);

class TransportMedia {
public:
    /// For cells of these edges; `theta` as in transport_sweep.h.
    TransportMedia(const DirectionSet& set, const std::array<double, 3>& edge_mm, double theta = 1);

    [[nodiscard]] TransportMedium operator()(const Medium& medium) const;
    /// The same in double precision: sigma_t, sigma_s.
    [[nodiscard]] std::array<double, 2> exact(const Medium& medium) const;
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
